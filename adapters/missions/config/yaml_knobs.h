// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/formats/files/strict_yaml.h"
#include "models/knobs.h"

namespace prospect {

/// Sets what is described from a mapping of a document: a key each, a mapping each group. What the
/// document does not hold stays as it is, and is the default that is told. Problems are the
/// document's, as with YamlMap.
class YamlKnobs final : public Knobs {
 public:
  enum class Missing { kDefault, kError };
  explicit YamlKnobs(YamlMap map, Missing missing = Missing::kDefault)
      : maps_{std::move(map)}, missing_(missing) {}

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
  void enter(const char* name) override { maps_.push_back(maps_.back().map(name)); }
  void leave() override { maps_.pop_back(); }

  std::vector<YamlMap> maps_;  ///< the last one: of the group that is described
  Missing missing_;            ///< of numbers
};

}  // namespace prospect
