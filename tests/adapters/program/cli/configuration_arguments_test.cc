// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/configuration_arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/explore.h"

// One rule says which value of a key counts, whatever its option: --set, the option, the file.
namespace prospect::configuration_arguments_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// An option that is a spelling of a key, with values that it may have and one that it may not.
struct Row {
  std::string option, key;
  std::string typed, told;  ///< on the command line; as config.yaml has it
  std::string file;         ///< that says otherwise
  std::string by_set;       ///< another one, as YAML
  std::string wrong;        ///< typed; "": there is none
};

const std::vector<Row>& rows() {
  static const std::vector<Row> all = {
      {"--solver", "planner.solver", "nlopt:LD_LBFGS", "\"nlopt:LD_LBFGS\"",
       "planner: {solver: ipopt}", "sampling", "ipop"},
      {"--sensors", "simulator.sensors", "camera", "camera", "simulator: {sensors: model}", "model",
       "eyes"},
      {"--time-limit", "mission.time_limit", "77", "77", "mission: {time_limit: 66}", "88", "0"},
      {"--start", "world.start", "1 -2 90", "[1, -2, 90]", "world: {start: [3, 4, 5]}", "[6, 7, 8]",
       "1 nan 0"},
      {"--floor", "world.floor", "-1.5", "\"-1.5\"", "world: {floor: 2}", "\"3\"", "low"},
      {"--resolution", "world.resolution", "0.2", "0.2", "world: {resolution: 0.3}", "0.4",
       "0.001"},
      {"--unknown", "world.unknown", "free", "free", "world: {unknown: solid}", "solid", "blocked"},
      {"--up", "world.up", "x", "x", "world: {up: y}", "z", "w"},
      {"--ground", "world.ground", "2", "2", "world: {ground: 3}", "4", "-1"},
      {"--go", "task.goal", "2,-1.5,90", "[2, -1.5, 90]", "task: {kind: go, goal: [7, 7]}",
       "[8, 8]", "1,nan"},
      {"--go", "task.kind", "2,-1.5", "go", "task: {kind: return}", "hold", ""},
      {"--go", "task.area", "2,-1.5", "[]", "task: {area: [0, 0, 2, 0, 2, 2]}",
       "[0, 0, 1, 0, 1, 1]", ""},
      {"--until", "mission.until.coverage", "0.5", "0.5", "mission: {until: {coverage: 0.6}}",
       "0.7", "1.5"},
      {"--until", "mission.until.area", "30m2", "30", "mission: {until: {area: 40}}", "50", "-1m2"},
      {"--return", "mission.return_when_done", "", "true", "mission: {return_when_done: false}",
       "false", ""},
      {"--correct", "simulator.corrections", "20:3,0,30", "[20, 3, 0, 30]",
       "simulator: {corrections: [1, 2, 3, 4]}", "[5, 6, 7, 8]", "20:3,0,nan"},
      {"--map", "simulator.map", "a map.bt", "\"a map.bt\"", "simulator: {map: b.bt}", "c.bt", ""},
  };
  return all;
}

std::vector<std::string> words(const std::string& text, bool one) {
  if (one) return {text};
  std::istringstream in(text);
  std::vector<std::string> all;
  for (std::string word; in >> word;) all.push_back(word);
  return all;
}

/// What is in effect of a key, by a file and a command line.
std::string in_effect(const std::string& key, const std::string& file,
                      std::vector<std::string> line) {
  ExploreArguments arguments;
  CLI::App app;
  add_mission_options(&app, arguments);
  add_world_options(&app, arguments);
  std::reverse(line.begin(), line.end());  // as CLI11 takes them
  app.parse(line);
  for (const ConfigEntry& e :
       configuration_from_text(file, "f.yaml", {}, arguments.configuration.settings()).entries) {
    if (e.path == key) return e.value;
  }
  return "no key";
}

std::vector<std::string> typed(const Row& row, const std::string& value) {
  std::vector<std::string> line = {row.option};
  if (value.empty()) return line;
  for (const std::string& word : words(value, row.option != "--start")) line.push_back(word);
  return line;
}

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  }
  return "none";
}

TEST(ConfigurationArguments, SetStandsAboveAnOptionAndAnOptionAboveTheFile) {
  for (const Row& row : rows()) {
    SCOPED_TRACE(row.option + " " + row.key);
    const std::vector<std::string> option = typed(row, row.typed);
    const std::string set = row.key + "=" + row.by_set;
    const auto value = [&](std::vector<std::string> line) {
      return in_effect(row.key, row.file, std::move(line));
    };
    EXPECT_NE(value({}), row.told);
    EXPECT_EQ(value(option), row.told);
    std::vector<std::string> before = {"--set", set}, after = option;
    before.insert(before.end(), option.begin(), option.end());
    after.insert(after.end(), {"--set", set});
    EXPECT_EQ(value(before), row.by_set);
    EXPECT_EQ(value(after), row.by_set);
    EXPECT_EQ(value({"--set", row.key + "=1", "--set", set}), row.by_set);
  }
}

// What an option takes is what its key takes, and is refused in the same words.
TEST(ConfigurationArguments, AnOptionIsCheckedAsItsKeyIs) {
  for (const Row& row : rows()) {
    if (row.wrong.empty()) continue;
    SCOPED_TRACE(row.option);
    const std::string by_option = refusal([&] { in_effect(row.key, "", typed(row, row.wrong)); });
    EXPECT_THAT(by_option, StartsWith(row.option + " " + row.wrong + ": " + row.key));
    EXPECT_THAT(by_option, HasSubstr("; expected "));
  }
  EXPECT_EQ(refusal([&] {
              in_effect("", "", {"--time-limit", "0"});
            }),
            "--time-limit 0: mission.time_limit: is '0'; expected a number from 1 to 1e+06 s");
  EXPECT_THROW(in_effect("", "", {"--time-limit", "5", "--time-limit", "6"}), CLI::ParseError);
}

/// The options of all commands that say in their help that they are spellings of keys: "--go" and
/// "task.goal".
std::set<std::pair<std::string, std::string>> options_of_keys() {
  CLI::App app;
  for (const auto add :
       {explore_command, drive_command, relay_command, report_command, export_command,
        solve_command, bench_command, replay_command, study_command, inspect_command,
        odometry_command, map_command, list_command, config_command}) {
    add(app);
  }
  std::set<std::pair<std::string, std::string>> found;
  for (const CLI::App* command : app.get_subcommands({})) {
    for (const CLI::Option* option : command->get_options()) {
      const std::string help = option->get_description();
      const std::size_t at = help.find("; key");
      if (at == std::string::npos) continue;
      std::istringstream keys(help.substr(help.find(' ', at + 2)));
      for (std::string key; keys >> key;) {
        if (key.ends_with(',')) key.pop_back();
        if (key.find('.') != std::string::npos && key[0] != '[')
          found.emplace(option->get_name(), key);
      }
    }
  }
  return found;
}

TEST(ConfigurationArguments, EachOptionOfAKeyIsInTheTableAndEachKeyIsOne) {
  std::set<std::string> keys;
  for (const ConfigEntry& e : read_configuration("").entries) keys.insert(e.path);
  std::set<std::pair<std::string, std::string>> tested = {
      {"--resolution", "perception.mapping.resolution"}};  // of map: the same mechanism
  for (const Row& row : rows()) tested.emplace(row.option, row.key);
  const auto found = options_of_keys();
  EXPECT_EQ(found, tested);
  for (const auto& [option, key] : found) EXPECT_TRUE(keys.contains(key)) << option << " " << key;
}

}  // namespace
}  // namespace prospect::configuration_arguments_test
