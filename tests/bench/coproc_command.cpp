// scansion_bench rank-coproc: ranks lines of a recorded scan on request, for another program's comparison.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/commands.hpp"
#include "tests/bench/our_ranking.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string_view>

namespace scansion::bench {
namespace {

struct Request {
  std::size_t first = 0, count = 0;
  double tolerance_mm = 0.0;
};

std::string_view next_word(std::string_view& text) {
  constexpr std::string_view kSpace = " \t\r";
  const std::size_t begin = std::min(text.find_first_not_of(kSpace), text.size());
  const std::size_t end = std::min(text.find_first_of(kSpace, begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

template <class T>
bool read_whole(std::string_view word, T& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

/// The reason when the request cannot be carried out, else nothing.
const char* parse(std::string_view text, std::size_t lines, Request& request) {
  if (next_word(text) != "run") return "a request is: run FIRST COUNT EPS";
  if (!read_whole(next_word(text), request.first)) return "FIRST is not a whole number";
  if (!read_whole(next_word(text), request.count)) return "COUNT is not a whole number";
  if (!read_whole(next_word(text), request.tolerance_mm) || !std::isfinite(request.tolerance_mm)) return "EPS is not a number";
  if (!next_word(text).empty()) return "words after EPS";
  if (request.count == 0) return "COUNT is 0";
  if (request.first >= lines || request.count > lines - request.first) return "lines out of range";
  return nullptr;
}

void answer(const Request& request, const LineSet& set, OurRanking& ranking) {
  std::vector<RunView> runs;
  for (std::size_t k = 0; k < request.count; ++k) {
    const auto more = runs_of(set.lines[request.first + k]);
    runs.insert(runs.end(), more.begin(), more.end());
  }
  std::size_t kept = 0;
  const double start = thread_ns();
  for (const RunView& run : runs) {
    if (request.tolerance_mm < 0.0) {
      ranking.full(run);
      kept += ranking.order().size();
    } else {
      ranking.distances(run);
      kept += ranking.kept(request.tolerance_mm);
    }
  }
  std::printf("ns %.0f kept %zu\n", thread_ns() - start, kept);
}

} // namespace

Result<void> run_rank_coproc(const std::string& file) {
  SCANSION_TRY(set, file_set(file));
  OurRanking ranking(set.resolution_mm);
  std::puts("ready");
  std::fflush(stdout);
  for (std::string text; std::getline(std::cin, text);) {
    Request request;
    if (const char* reason = parse(text, set.lines.size(), request))
      std::printf("error %s\n", reason);
    else
      answer(request, set, ranking);
    std::fflush(stdout);
  }
  return success();
}

} // namespace scansion::bench
