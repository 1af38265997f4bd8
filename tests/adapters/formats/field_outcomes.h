// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/files/field_rule.h"

namespace prospect::test {

/// The keys that a reader's source asks for: what `call` has in parentheses.
inline std::set<std::string> keys_asked_for(const std::string& source, const std::string& call) {
  std::ifstream file(std::string(PROSPECT_SOURCE_DIR) + "/" + source);
  std::stringstream text;
  text << file.rdbuf();
  const std::string code = text.str();
  const std::regex asked(call);
  std::set<std::string> keys;
  for (std::sregex_iterator it(code.begin(), code.end(), asked), end; it != end; ++it) {
    keys.insert((*it)[1]);
  }
  return keys;
}

/// Holds a table against what reading makes of each field: `read` gives what is read of a file with
/// the field replaced by a value, as text, "refused..." if it is; "": as it is. others: for each
/// field values that are not the file's.
inline void expect_fields(
    std::span<const FieldRule> table, const std::map<std::string, std::vector<std::string>>& others,
    const std::function<std::string(const std::string& field, const std::string& value)>& read) {
  const std::string before = read("", "");
  ASSERT_FALSE(before.starts_with("refused")) << before;
  std::set<std::string> listed;
  for (const FieldRule& rule : table) {
    SCOPED_TRACE(rule.name);
    EXPECT_TRUE(listed.insert(rule.name).second) << "listed twice";
    EXPECT_EQ(std::strlen(rule.why) > 0, rule.use == FieldUse::kNotNeeded);
    ASSERT_TRUE(others.contains(rule.name));
    for (const std::string& value : others.at(rule.name)) {
      const std::string after = read(rule.name, value);
      const bool refused = after.starts_with("refused");
      switch (rule.use) {
        case FieldUse::kUsed:
          EXPECT_FALSE(refused) << value << ": " << after;
          EXPECT_NE(after, before) << value;
          break;
        case FieldUse::kChecked:
        case FieldUse::kRefused:
          EXPECT_TRUE(refused) << value << ": " << after;
          break;
        case FieldUse::kNotNeeded:
          EXPECT_EQ(after, before) << value;
      }
    }
  }
  EXPECT_EQ(listed.size(), others.size());
}

}  // namespace prospect::test
