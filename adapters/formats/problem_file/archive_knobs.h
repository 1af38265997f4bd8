// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/formats/problem_file/archive.h"
#include "models/knobs.h"

namespace prospect {

/// What is described as entries of an archive: an attribute each, of the knob's name and range, in
/// the unit of the structure (angles in rad); a group each group. What values must agree in is
/// checked too.
class ArchiveKnobs final : public Knobs {
 public:
  explicit ArchiveKnobs(Archive& archive) : archive_(&archive) {}

  void number(const char* name, double& value, Range range, const char* unit,
              const char* sentence) override;
  void degrees(const char* name, double& radians, Range range, const char* sentence) override;
  void integer(const char* name, int& value, WholeRange range, const char* unit,
               const char* sentence) override;
  void boolean(const char* name, bool& value, const char* sentence) override;
  void numbers(const char* name, double* values, std::size_t count, Range range, const char* unit,
               const char* sentence) override;
  void require(bool holds, const char* name, const char* what) override;

 private:
  void word(const char* name, std::size_t& index, const std::vector<std::string>& words,
            const char* sentence) override;
  void enter(const char* name) override { archive_->begin_group(name); }
  void leave() override { archive_->end_group(); }

  Archive* archive_;
};

}  // namespace prospect
