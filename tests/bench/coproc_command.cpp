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
  const FlatRuns flat = set.flat_runs(request.first, request.count);
  const double start = thread_ns();
  const std::size_t kept = ranking.full(flat, request.tolerance_mm);
  const double spent = thread_ns() - start;
  std::printf("ns %.0f kept %zu\n", spent, kept);
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
