// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/problem_file/archive_knobs.h"

#include "models/range_text.h"

namespace prospect {

void ArchiveKnobs::number(const char* name, double& value, Range range, const char* /*unit*/,
                          const char* /*sentence*/) {
  archive_->number(name, value, range.min, range.max);
}

void ArchiveKnobs::degrees(const char* name, double& radians, Range range,
                           const char* /*sentence*/) {
  constexpr double kRounding = 1e-3;  // [rad], as in KnobCheck
  archive_->number(name, radians, range.min * kRadiansPerDegree,
                   range.max * kRadiansPerDegree + kRounding);
}

void ArchiveKnobs::integer(const char* name, int& value, WholeRange range, const char* /*unit*/,
                           const char* /*sentence*/) {
  archive_->integer(name, value, range.min, range.max);
}

void ArchiveKnobs::boolean(const char* name, bool& value, const char* /*sentence*/) {
  archive_->flag(name, value);
}

void ArchiveKnobs::numbers(const char* name, double* values, std::size_t count, Range range,
                           const char* unit, const char* /*sentence*/) {
  archive_->numbers(name, values, {count});
  for (std::size_t i = 0; i < count; ++i) {
    if (values[i] >= range.min && values[i] <= range.max) continue;
    archive_->refuse(name, "holds " + exact_text(values[i]),
                     "numbers" + in_range(range.min, range.max, unit));
  }
}

void ArchiveKnobs::word(const char* name, std::size_t& index, const std::vector<std::string>& words,
                        const char* /*sentence*/) {
  archive_->choice(name, index, words);
}

void ArchiveKnobs::require(bool holds, const char* name, const char* what) {
  if (!holds) archive_->refuse(name, what);
}

}  // namespace prospect
