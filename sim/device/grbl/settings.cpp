// The numbered settings of a Grbl controller.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/grbl/settings.hpp"

#include <cmath>
#include <cstdio>

namespace scansion::sim::grbl {
namespace {

constexpr int kBadStatement = 3, kNegative = 4, kShortPulse = 6, kNeedsHoming = 10;

/// Settings below 100 that are no whole numbers.
bool has_decimals(int number) noexcept {
  return number == 11 || number == 12 || number == 24 || number == 25 || number == 27 || number >= 100;
}

} // namespace

Settings::Settings()
    : values_{{0, 10},     {1, 25},    {2, 0},    {3, 0},    {4, 0},     {5, 0},     {6, 0},     {10, 1},    {11, 0.01},
              {12, 0.002}, {13, 0},    {20, 0},   {21, 0},   {22, 0},    {23, 0},    {24, 25},   {25, 500},  {26, 250},
              {27, 1},     {30, 1000}, {31, 0},   {32, 0},   {100, 250}, {101, 250}, {102, 250}, {110, 500}, {111, 500},
              {112, 500},  {120, 10},  {121, 10}, {122, 10}, {130, 200}, {131, 200}, {132, 200}} {}

int Settings::set(double number, double value) {
  constexpr double kHighest = 255.0;
  if (!(number >= 0.0 && number <= kHighest)) return kBadStatement;
  if (value < 0.0) return kNegative;
  const auto at = values_.find(static_cast<int>(number));
  if (at == values_.end() || number != std::floor(number)) return kBadStatement;
  const int key = at->first;
  if (key == 0 && value < 3.0) return kShortPulse;
  if (key == 20 && value != 0.0 && !is_on(22)) return kNeedsHoming;
  if (key == 22 && value == 0.0) values_.at(20) = 0.0; // soft limits mean nothing without homing
  const bool is_flag = key == 4 || key == 5 || key == 6 || key == 13 || (key >= 20 && key <= 22) || key == 32;
  at->second = is_flag ? (value != 0.0 ? 1.0 : 0.0) : has_decimals(key) ? value : std::floor(value);
  return 0;
}

std::string Settings::listing() const {
  std::string out;
  for (const auto& [number, value] : values_) {
    char text[48];
    std::snprintf(text, sizeof text, "$%d=%.*f\r\n", number, has_decimals(number) ? 3 : 0, value);
    out += text;
  }
  return out;
}

} // namespace scansion::sim::grbl
