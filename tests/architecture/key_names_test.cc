// SPDX-License-Identifier: Apache-2.0
// A key of the configuration has one name: what the program and the pages print is what `--set`
// takes. The keys are those of docs/reference/configuration.md, which the program writes and a test
// compares.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/architecture/docs_pages.h"

namespace prospect::key_names_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

const fs::path kRoot = PROSPECT_SOURCE_DIR;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// All matches of an expression's first group.
std::vector<std::string> matches(const std::string& text, const std::regex& expression) {
  std::vector<std::string> all;
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it) {
    all.push_back((*it)[1]);
  }
  return all;
}

/// "zones.slow[0].area" as "zones.slow.area".
std::string without_index(const std::string& key) {
  static const std::regex index(R"(\[\d*\])");
  return std::regex_replace(key, index, "");
}

/// The keys of the reference, and the groups that they stand in.
const std::set<std::string>& known_keys() {
  static const std::set<std::string> all = [] {
    static const std::regex row(R"(\n\| `([^`]+)` \|)");
    std::set<std::string> keys;
    for (const std::string& path :
         matches(text_of(kRoot / "docs/reference/configuration.md"), row)) {
      const std::string key = without_index(path);
      for (std::size_t dot = key.find('.'); dot != std::string::npos;
           dot = key.find('.', dot + 1)) {
        keys.insert(key.substr(0, dot));
      }
      keys.insert(key);
    }
    return keys;
  }();
  return all;
}

/// What is written as a key and is none.
std::vector<std::string> no_keys(const std::string& text) {
  static const std::regex written(
      R"((?:^|[^\w./*-])((?:robot|planner|simulator|perception|world|guard|mission|task|zones|drive|gazebo)(?:\.[A-Za-z_]\w*(?:\[\d*\])?)+))");
  static const std::regex other(
      R"((robot|planner|world|mission|zones)\.(yaml|mcap|h|cc|KEY)|gazebo\.msgs\.\w+)");
  static const std::regex free(R"(planner\.(options|terms)\..*)");  // as back ends and terms say
  std::vector<std::string> found;
  for (const std::string& name : matches(text, written)) {
    const std::string key = without_index(name);
    if (!known_keys().contains(key) && !std::regex_match(key, other) &&
        !std::regex_match(key, free)) {
      found.push_back(name);
    }
  }
  return found;
}

TEST(KeyNames, WhatTheProgramPrintsIsAKey) {
  static const std::regex literal(R"re("((?:[^"\\\n]|\\.)*)")re");
  std::vector<std::string> found;
  for (const char* top : {"models", "engine", "solvers", "problems", "perception", "runtime",
                          "adapters", "benchmarks"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top)) {
      const fs::path& path = entry.path();
      if (path.extension() != ".h" && path.extension() != ".cc") continue;
      if (path.filename() == "renamed_keys.cc") continue;  // of names that were
      std::istringstream lines(text_of(path));
      std::string line;
      for (int number = 1; std::getline(lines, line); ++number) {
        if (line.find('"') == std::string::npos || line.find("//") < line.find('"')) continue;
        for (const std::string& text : matches(line, literal)) {
          for (const std::string& name : no_keys(text)) {
            found.push_back(fs::relative(path, kRoot).generic_string() + ":" +
                            std::to_string(number) + ": " + name);
          }
        }
      }
    }
  }
  EXPECT_THAT(found, IsEmpty());
  EXPECT_GT(known_keys().size(), 500U);
}

TEST(KeyNames, WhatThePagesNameIsAKey) {
  static const std::regex span("`([^`]*)`");
  std::vector<std::string> found;
  for (const fs::path& page : test::pages_of(kRoot)) {
    for (const auto& [number, line] : test::prose_of(page, false)) {
      for (const std::string& text : matches(line, span)) {
        if (text.find('(') != std::string::npos) continue;  // a call of a program
        for (const std::string& name : no_keys(text)) {
          found.push_back(fs::relative(page, kRoot).generic_string() + ":" +
                          std::to_string(number) + ": " + name);
        }
      }
    }
  }
  EXPECT_THAT(found, IsEmpty());
}

// The tables that `prospect list` prints, which the pages hold, name times and shares by the last
// part of their keys.
TEST(KeyNames, WhatTheTablesOfModesNameIsAKey) {
  static const std::regex name(R"(([a-z]+(?:_[a-z]+)+))");
  for (const auto& [page, group] :
       {std::pair<const char*, const char*>{"behaviour", "planner.recovery."},
        {"drive_modes", "drive.mode."}}) {
    SCOPED_TRACE(page);
    std::set<std::string> named;
    for (const auto& [number, line] :
         test::prose_of(kRoot / "docs/reference" / (std::string(page) + ".md"), false)) {
      if (!line.starts_with("| ")) continue;
      std::string text;  // but for whole keys
      for (const std::string& word : matches(line, std::regex(R"((\S+))"))) {
        if (word.find('.') == std::string::npos) text += word + ' ';
      }
      for (const std::string& key : matches(text, name)) named.insert(key);
    }
    for (const std::string& key : named) {
      EXPECT_TRUE(known_keys().contains(group + key)) << group + key;
    }
    EXPECT_GE(named.size(), 4U);
  }
}

// A key whose member nobody reads has no effect.
TEST(KeyNames, EachMemberThatIsDescribedIsRead) {
  static const std::regex described(R"(knobs\.\w+\(\s*"\w+",\s*(?:\w+\.)*(\w+))");
  static const std::regex used(R"((?:\.|->|::)(\w+))");
  std::set<std::string> members, read;
  for (const char* top : {"models", "engine", "perception", "runtime", "adapters"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cc") continue;
      std::string text = text_of(entry.path());
      for (std::size_t at; (at = text.find("\nvoid describe")) != std::string::npos;) {
        std::size_t end = text.find_first_of("{;", at);  // of a declaration
        if (text[end] == '{') end = text.find("\n}", at);
        for (const std::string& member : matches(text.substr(at, end - at), described)) {
          members.insert(member);
        }
        text.erase(at, end - at);
      }
      for (const std::string& member : matches(text, used)) read.insert(member);
    }
  }
  std::vector<std::string> unread;
  std::set_difference(members.begin(), members.end(), read.begin(), read.end(),
                      std::back_inserter(unread));
  EXPECT_THAT(unread, IsEmpty());
  EXPECT_GT(members.size(), 300U);
}

TEST(KeyNames, WhatIsNoKeyIsFound) {
  EXPECT_THAT(no_keys("planner.recovery.time is planner.recovery.retreat_time"),
              ElementsAre("planner.recovery.time"));
  EXPECT_THAT(no_keys("expected zones.keep_out[0].area, zones.slow[].speed, task: go"),
              ElementsAre("zones.slow[].speed"));
  EXPECT_THAT(no_keys("runs/mission.mcap, planner.options.basins, a.planner.x, planner.recovery"),
              IsEmpty());
}

}  // namespace
}  // namespace prospect::key_names_test
