// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"

#include <cmath>
#include <stdexcept>

#include "models/nearest_name.h"
#include "models/range_text.h"

namespace prospect {

std::string KnobCheck::subject(const char* name) const {
  std::string text = std::string(owner_) + ": ";
  for (const char* group : groups_) text += std::string(group) + '.';
  return text + name;
}

void KnobCheck::number(const char* name, double& value, Range range, const char* unit,
                       const char* /*sentence*/) {
  if (value >= range.min && value <= range.max) return;
  throw std::invalid_argument(subject(name) + " is " + exact_text(value) + "; expected a number" +
                              in_range(range.min, range.max, unit));
}

void KnobCheck::degrees(const char* name, double& radians, Range range, const char* /*sentence*/) {
  constexpr double kRounding = 1e-3;  // [rad]: 6.2832 is meant to be all round
  if (radians >= range.min * kRadiansPerDegree - (range.min > 0.0 ? kRounding : 0.0) &&
      radians <= range.max * kRadiansPerDegree + kRounding) {
    return;
  }
  throw std::invalid_argument(subject(name) + " is " + exact_text(radians / kRadiansPerDegree) +
                              "; expected a number" + in_range(range.min, range.max, "deg"));
}

void KnobCheck::integer(const char* name, int& value, WholeRange range, const char* unit,
                        const char* /*sentence*/) {
  if (value >= range.min && value <= range.max) return;
  throw std::invalid_argument(subject(name) + " is " + exact_text(value) +
                              "; expected a whole number" + in_range(range.min, range.max, unit));
}

void KnobCheck::numbers(const char* name, double* values, std::size_t count, Range range,
                        const char* unit, const char* sentence) {
  for (std::size_t i = 0; i < count; ++i) number(name, values[i], range, unit, sentence);
}

void KnobCheck::word(const char* name, std::size_t& index, const std::vector<std::string>& words,
                     const char* /*sentence*/) {
  if (index < words.size()) return;
  throw std::invalid_argument(subject(name) + " is no value of its type" + expected_one_of(words));
}

void KnobCheck::require(bool holds, const char* name, const char* what) {
  if (!holds) throw std::invalid_argument(subject(name) + ": " + what);
}

}  // namespace prospect
