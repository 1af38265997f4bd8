// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/yaml_knobs.h"

#include <algorithm>

namespace prospect {

void YamlKnobs::number(const char* name, double& value, Range range, const char* unit,
                       const char* sentence) {
  value = missing_ == Missing::kError
              ? maps_.back().required_number(name, range.min, range.max, unit, sentence)
              : maps_.back().number(name, value, range.min, range.max, unit, sentence);
}

void YamlKnobs::degrees(const char* name, double& radians, Range range, const char* sentence) {
  double value = radians / kRadiansPerDegree;
  number(name, value, range, "deg", sentence);
  radians = kRadiansPerDegree * value;
}

void YamlKnobs::integer(const char* name, int& value, WholeRange range, const char* unit,
                        const char* sentence) {
  value = static_cast<int>(maps_.back().integer(name, value, range.min, range.max, unit, sentence));
}

void YamlKnobs::boolean(const char* name, bool& value, const char* sentence) {
  value = maps_.back().boolean(name, value, sentence);
}

void YamlKnobs::numbers(const char* name, double* values, std::size_t count, Range range,
                        const char* unit, const char* sentence) {
  const int size = static_cast<int>(count);
  const std::vector<double> read =
      missing_ == Missing::kError
          ? maps_.back().required_numbers(name, size, range.min, range.max, unit, sentence)
          : maps_.back().numbers(name, {values, values + count}, size, range.min, range.max, unit,
                                 sentence);
  std::copy(read.begin(), read.end(), values);
}

void YamlKnobs::word(const char* name, std::size_t& index, const std::vector<std::string>& words,
                     const char* sentence) {
  const std::string chosen = maps_.back().choice(name, words.at(index), words, sentence);
  index = static_cast<std::size_t>(std::find(words.begin(), words.end(), chosen) - words.begin());
}

void YamlKnobs::require(bool holds, const char* name, const char* what) {
  if (!holds) maps_.back().problem(name, what);
}

}  // namespace prospect
