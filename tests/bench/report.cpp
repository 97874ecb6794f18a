// Tables for a person and for programs.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/report.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace scansion::bench {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Figure& figure) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", figure.decimals, figure.value);
  return text.data();
}

std::string text_of(const Count& count) {
  std::string text = std::to_string(count.value);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, ",");
  return text;
}

std::string text_of(const Cell& cell) {
  if (const auto* words = std::get_if<std::string>(&cell)) return *words;
  if (const auto* figure = std::get_if<Figure>(&cell)) return text_of(*figure);
  if (const auto* count = std::get_if<Count>(&cell)) return text_of(*count);
  return {};
}

Json json_of(const Cell& cell) {
  if (const auto* words = std::get_if<std::string>(&cell)) return *words;
  if (const auto* figure = std::get_if<Figure>(&cell)) return figure->value;
  if (const auto* count = std::get_if<Count>(&cell)) return count->value;
  return nullptr;
}

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string space(width - std::min(width, text.size()), ' ');
  return left ? text + space : space + text;
}

void print_markdown(const Table& table) {
  std::vector<std::vector<std::string>> rows{table.columns()};
  for (const auto& row : table.rows()) {
    auto& texts = rows.emplace_back();
    for (std::size_t c = 0; c < table.columns().size(); ++c) texts.push_back(c < row.size() ? text_of(row[c]) : "");
  }
  std::vector<std::size_t> widths(table.columns().size(), 3);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());

  std::string out = "### " + table.title() + "\n\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < widths.size(); ++c) out += "| " + padded(rows[r][c], widths[c], c == 0) + " ";
    out += "|\n";
    if (r != 0) continue;
    for (std::size_t c = 0; c < widths.size(); ++c)
      out += c == 0 ? "|" + std::string(widths[c] + 2, '-') : "|" + std::string(widths[c] + 1, '-') + ":";
    out += "|\n";
  }
  if (!table.note().empty()) out += "\n" + table.note() + "\n";
  std::printf("%s\n", out.c_str());
  std::fflush(stdout);
}

Json json_of(const Table& table) {
  Json rows = Json::array();
  for (const auto& row : table.rows()) {
    Json object = Json::object();
    for (std::size_t c = 0; c < row.size(); ++c) object[table.columns()[c]] = json_of(row[c]);
    rows.push_back(std::move(object));
  }
  return {{"title", table.title()}, {"note", table.note()}, {"rows", std::move(rows)}};
}

} // namespace

void Report::print(const Table& table) {
  if (json_)
    tables_.push_back(table);
  else
    print_markdown(table);
}

void Report::finish() {
  if (!json_) return;
  Json out = {{"tables", Json::array()}, {"failed", failed_}};
  for (const Table& table : tables_) out["tables"].push_back(json_of(table));
  std::printf("%s\n", out.dump(2).c_str());
}

void Report::judge(std::vector<Cell>& cells, double value, const std::optional<Bar>& bar) {
  if (!bar) {
    cells.resize(cells.size() + 3);
    return;
  }
  mark(cells, *bar, value <= bar->good, value <= bar->must);
}

void Report::judge_high(std::vector<Cell>& cells, double value, const Bar& bar) {
  mark(cells, bar, value >= bar.good, value >= bar.must);
}

void Report::mark(std::vector<Cell>& cells, const Bar& bar, bool good, bool pass) {
  constexpr int kDecimals = 3;
  cells.insert(cells.end(), {Figure{bar.must, kDecimals}, Figure{bar.good, kDecimals}});
  if (good) {
    cells.emplace_back("good");
  } else if (pass) {
    cells.emplace_back("pass");
  } else {
    cells.emplace_back("FAIL");
    ++failed_;
  }
}

} // namespace scansion::bench
