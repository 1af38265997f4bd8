// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/strict_yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

namespace prospect::strict_yaml_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Settings {
  double weight = 0.0, limit = 0.0;
  std::int64_t count = 0;
  bool on = false;
  std::string mode, title;
  std::vector<double> box;
  std::vector<std::string> tags;
  std::vector<std::string> rooms;
};

Settings read(StrictYaml& yaml) {
  Settings s;
  YamlMap root = yaml.root();
  YamlMap planner = root.map("planner");
  s.weight = planner.number("weight", 0.5, 0.0, 100.0, "1", "weight of the term");
  s.limit =
      planner.number("limit", std::numeric_limits<double>::infinity(), 0.0, 1e6, "s", "limit");
  s.count = planner.integer("count", 20, 1, 100, "1", "stages");
  s.on = planner.boolean("on", true, "whether");
  s.mode = root.choice("mode", "braking", {"free", "blocked", "braking"}, "policy");
  s.title = root.text("title", "a run", "title");
  s.box = root.numbers("box", {0.0, 1.0}, 2, -10.0, 10.0, "m", "box");
  s.tags = root.texts("tags", {}, "tags");
  for (YamlMap& room : root.maps("rooms")) s.rooms.push_back(room.required_text("name", "name"));
  return s;
}

std::vector<std::string> problems(const std::string& text) {
  try {
    StrictYaml yaml = StrictYaml::from_text(text, "f.yaml");
    read(yaml);
    yaml.finish();
  } catch (const InputError& e) {
    return e.lines();
  }
  return {};
}

TEST(StrictYaml, ReadsWhatIsThere) {
  StrictYaml yaml = StrictYaml::from_text(
      "planner: {weight: 1e-3, count: 7, on: false}\nmode: free\ntitle: \"x: y\"\n"
      "box: [-1.5, 2]\ntags: [a, b]\nrooms:\n  - {name: hall}\n  - {name: attic}\n",
      "f.yaml");
  const Settings s = read(yaml);
  yaml.finish();
  EXPECT_EQ(s.weight, 1e-3);
  EXPECT_EQ(s.count, 7);
  EXPECT_FALSE(s.on);
  EXPECT_EQ(s.mode, "free");
  EXPECT_EQ(s.title, "x: y");
  EXPECT_THAT(s.box, ElementsAre(-1.5, 2.0));
  EXPECT_THAT(s.tags, ElementsAre("a", "b"));
  EXPECT_THAT(s.rooms, ElementsAre("hall", "attic"));
}

TEST(StrictYaml, EmptyDocumentGivesDefaults) {
  for (const char* text : {"", "# nothing\n", "planner:\n", "---\n"}) {
    StrictYaml yaml = StrictYaml::from_text(text, "f.yaml");
    const Settings s = read(yaml);
    EXPECT_NO_THROW(yaml.finish()) << text;
    EXPECT_EQ(s.weight, 0.5);
    EXPECT_EQ(s.mode, "braking");
  }
}

TEST(StrictYaml, ReportsAllProblemsInOrderOfLines) {
  const auto lines = problems(
      "planner:\n  wieght: 3\n  count: 1000\n  count: 4\n  on: yes\nmode: brakin\nbox: [1, .nan]\n"
      "extra: 1\n");
  ASSERT_EQ(lines.size(), 7u) << InputError(lines).what();
  EXPECT_THAT(lines[0],
              HasSubstr("f.yaml:2: unknown key 'planner.wieght' (did you mean 'weight'?)"));
  EXPECT_THAT(lines[1],
              HasSubstr("f.yaml:3: planner.count: is '1000'; expected a whole number from 1"));
  EXPECT_THAT(lines[2], HasSubstr("f.yaml:4: duplicate key 'count', first in line 3"));
  EXPECT_THAT(lines[3], HasSubstr("f.yaml:5: planner.on: is 'yes'; expected true or false"));
  EXPECT_THAT(lines[4], HasSubstr("f.yaml:6: mode: is 'brakin' (did you mean 'braking'?)"));
  EXPECT_THAT(lines[5], HasSubstr("f.yaml:7: box: entry 2 is '.nan'"));
  EXPECT_THAT(lines[6], HasSubstr("f.yaml:8: unknown key 'extra'"));
  for (const std::string& line : lines) EXPECT_THAT(line, HasSubstr("expected"));
}

TEST(StrictYaml, NumbersAreStrict) {
  for (const char* bad : {"0,5", ".nan", "nan", ".inf", "-inf", "1e999", "\"1\"", "yes", "0x10",
                          "1_0", "+1", "1 m", "-0.1", "100.1", "[1]", "{a: 1}", "", "~"}) {
    EXPECT_EQ(problems(std::string("planner: {weight: ") + bad + "}\n").size(), 1u) << bad;
  }
  for (const char* good : {"0", "100", "1e-3", "2.5E1", ".5", "0.5"}) {
    EXPECT_TRUE(problems(std::string("planner: {weight: ") + good + "}\n").empty()) << good;
  }
  for (const char* bad : {"1.0", "1e1", "0", "101", "99999999999999999999"}) {
    EXPECT_EQ(problems(std::string("planner: {count: ") + bad + "}\n").size(), 1u) << bad;
  }
}

TEST(StrictYaml, WrongShapesAreErrorsNotCrashes) {
  EXPECT_EQ(problems("planner: 3\n").size(), 1u);
  EXPECT_EQ(problems("rooms: {name: x}\n").size(), 1u);
  EXPECT_EQ(problems("rooms: [1, 2]\n").size(), 2u);
  EXPECT_EQ(problems("rooms: [{}]\n").size(), 1u);
  EXPECT_EQ(problems("box: [1]\n").size(), 1u);
  EXPECT_EQ(problems("tags: [[a]]\n").size(), 1u);
  EXPECT_EQ(problems("[1, 2]: 3\n").size(), 2u);
  EXPECT_EQ(problems("- 1\n").size(), 1u);
  EXPECT_EQ(problems("7\n").size(), 1u);
  EXPECT_EQ(problems("a: [1\n").size(), 1u);
  EXPECT_EQ(problems("title: x\n---\ntitle: y\n").size(), 1u);
  EXPECT_EQ(problems("title: &a x\nmode: *a\n").size(), 2u);
  EXPECT_EQ(problems(std::string("title: x\0y\n", 11)).size(), 1u);
  EXPECT_EQ(problems(std::string(100000, '[')).size(), 1u);
  EXPECT_EQ(problems("a: &a [*a]\n").size(), 2u);
}

TEST(StrictYaml, BadFilesGiveOneLine) {
  const std::string folder = ::testing::TempDir();
  for (const std::string& path :
       {folder + "/absent.yaml", folder, std::string("/dev/zero"), std::string("/dev/null")}) {
    try {
      StrictYaml::from_file(path);
      FAIL() << path;
    } catch (const InputError& e) {
      EXPECT_EQ(e.lines().size(), 1u);
      EXPECT_THAT(e.what(), HasSubstr(path + ": "));
      EXPECT_THAT(e.what(), HasSubstr("expected"));
    }
  }
}

TEST(StrictYaml, AHundredThousandProblemsEndAtOnce) {
  std::string unknown, duplicate;
  for (int n = 0; n < 100000; ++n) {
    unknown += "key_" + std::to_string(n) + ": 1\n";
    duplicate += "same: 1\n";
  }
  for (const std::string& text : {unknown, duplicate}) {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<std::string> lines = problems(text);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    EXPECT_LT(took.count(), 10.0);
    ASSERT_GE(lines.size(), 2u);
    EXPECT_LE(lines.size(), 101u);
    EXPECT_THAT(lines.back(), HasSubstr("more problems"));
  }
}

TEST(StrictYaml, OtherProgramsKeysCanBeLeft) {
  StrictYaml yaml = StrictYaml::from_text("a_number: 1\nmap_type: 2\nother: {x: 1}\n", "f.yaml");
  YamlMap root = yaml.root();
  root.number("a_number", 0.0, 0.0, 9.0, "m", "");
  EXPECT_EQ(root.leave_rest(), (std::vector<std::string>{"map_type", "other"}));
  EXPECT_NO_THROW(yaml.finish());
  StrictYaml slip = StrictYaml::from_text("a_nubmer: 1\nmap_type: 2\n", "f.yaml");
  root = slip.root();
  root.number("a_number", 0.0, 0.0, 9.0, "m", "");
  EXPECT_EQ(root.leave_rest(), std::vector<std::string>{"map_type"});
  EXPECT_THROW(slip.finish(), InputError);
}

TEST(StrictYaml, LooseSpellingsWhereTheyAreTaken) {
  const std::string text = "a: '0.5'\nb: +2\nc: \"yes\"\nd: Off\ne: +-1\n";
  StrictYaml yaml = StrictYaml::from_text(text, "f.yaml");
  yaml.accept_quoted_numbers();
  YamlMap root = yaml.root();
  EXPECT_EQ(root.number("a", 0, 0, 9, "", ""), 0.5);
  EXPECT_EQ(root.number("b", 0, 0, 9, "", ""), 2.0);
  EXPECT_TRUE(root.loose_boolean("c", false, ""));
  EXPECT_FALSE(root.loose_boolean("d", true, ""));
  EXPECT_TRUE(root.loose_boolean("absent", true, ""));
  EXPECT_EQ(root.problem_count(), 0u);
  root.number("e", 0, -9, 9, "", "");
  root.loose_boolean("a", false, "");
  EXPECT_EQ(root.problem_count(), 2u);
}

TEST(StrictYaml, CallersAddProblemsOfTheirOwn) {
  StrictYaml yaml = StrictYaml::from_text("\nplanner:\n  weight: 1\n", "f.yaml");
  YamlMap planner = yaml.root().map("planner");
  planner.number("weight", 0, 0, 10, "1", "");
  EXPECT_EQ(planner.where("weight"), "f.yaml:3");
  planner.problem("weight", "odd\n\x1b[2J; expected even");
  EXPECT_THROW(
      {
        try {
          yaml.finish();
        } catch (const InputError& e) {
          EXPECT_STREQ(e.what(), "f.yaml:3: planner.weight: odd??[2J; expected even");
          throw;
        }
      },
      InputError);
}

TEST(StrictYaml, EffectiveConfigurationReadsBackTheSame) {
  StrictYaml yaml = StrictYaml::from_text(
      "planner: {weight: 0.1, count: 7}\ntitle: 'a \"b\" #c'\ntags: [x, 'true', '1']\n"
      "rooms:\n  - {name: hall}\n  - {name: two words}\n",
      "f.yaml");
  const Settings s = read(yaml);
  yaml.finish();
  const std::string text = effective_yaml(yaml.entries());
  EXPECT_THAT(text, HasSubstr("# weight of the term [1], default 0.5"));
  StrictYaml again = StrictYaml::from_text(text, "effective");
  const Settings t = read(again);
  ASSERT_NO_THROW(again.finish()) << text;
  EXPECT_EQ(s.weight, t.weight);
  EXPECT_EQ(s.limit, t.limit);
  EXPECT_EQ(s.count, t.count);
  EXPECT_EQ(s.on, t.on);
  EXPECT_EQ(s.mode, t.mode);
  EXPECT_EQ(s.title, t.title);
  EXPECT_EQ(s.box, t.box);
  EXPECT_EQ(s.tags, t.tags);
  EXPECT_EQ(s.rooms, t.rooms);
  EXPECT_EQ(text, effective_yaml(again.entries())) << "apart from where a value came from";
}

TEST(StrictYaml, SurvivesMutatedText) {
  const std::string good =
      "planner: {weight: 0.1, count: 7, on: true}\ntitle: 'a b'\nbox: [1, 2]\ntags: [x, y]\n"
      "rooms:\n  - {name: hall}\n  - name: attic\n";
  std::mt19937_64 random(7);
  int accepted = 0;
  for (int n = 0; n < 3000; ++n) {
    std::string text = good;
    const std::size_t edits = 1 + random() % 4;
    for (std::size_t e = 0; e < edits; ++e) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = static_cast<char>(random() & 0xff);
          break;
        case 1:
          text.erase(at, 1 + random() % 8);
          break;
        default:
          text.insert(at, 1, "{}[]:,-#&*!|>'\"%@\n\t "[random() % 20]);
      }
      if (text.empty()) text.push_back(' ');
    }
    try {
      StrictYaml yaml = StrictYaml::from_text(text, "f.yaml");
      read(yaml);
      yaml.finish();
      ++accepted;
    } catch (const InputError& e) {
      for (const std::string& line : e.lines()) {
        ASSERT_EQ(line.find('\n'), std::string::npos) << text;
        ASSERT_THAT(line, HasSubstr("f.yaml"));
      }
    }
  }
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, 3000);
}

}  // namespace
}  // namespace prospect::strict_yaml_test
