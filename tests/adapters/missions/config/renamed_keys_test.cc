// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/renamed_keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/config/configuration.h"

namespace prospect::renamed_keys_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::vector<std::string> refusals(const std::string& yaml,
                                  const std::vector<YamlSetting>& settings) {
  try {
    configuration_from_text(yaml, "f.yaml", {}, settings);
  } catch (const InputError& e) {
    return e.lines();
  }
  return {};
}

/// "a.b.c" as "a: {b: {c: VALUE}}".
std::string nested(std::string key, const std::string& value) {
  std::string end = ": " + value;
  for (std::size_t dot; (dot = key.find('.')) != std::string::npos;) {
    key = key.substr(0, dot) + ": {" + key.substr(dot + 1);
    end += '}';
  }
  return key + end;
}

const ConfigEntry& entry_of(const Configuration& configuration, const std::string& path) {
  const auto entry = std::find_if(configuration.entries.begin(), configuration.entries.end(),
                                  [&](const ConfigEntry& e) { return e.path == path; });
  if (entry == configuration.entries.end()) throw std::out_of_range(path);
  return *entry;
}

TEST(RenamedKeys, EachIsReadByItsNewNameAndSaysSo) {
  const std::vector<ConfigEntry> keys = read_configuration("").entries;
  for (const RenamedKey& renamed : renamed_keys()) {
    const auto before_of = [&](const ConfigEntry& e) {
      return renamed.before + e.path.substr(renamed.now.size());
    };
    // Its own key now, or the first below it that no row above is for.
    const auto now = std::find_if(keys.begin(), keys.end(), [&](const ConfigEntry& e) {
      if (e.path != renamed.now && !e.path.starts_with(renamed.now + ".")) return false;
      const std::string key = before_of(e);
      const auto row =
          std::find_if(renamed_keys().begin(), renamed_keys().end(), [&](const RenamedKey& one) {
            return key == one.before || key.starts_with(one.before + ".");
          });
      return row->before == renamed.before;
    });
    ASSERT_NE(now, keys.end()) << renamed.now << " is no key";
    const std::string before = before_of(*now);
    for (const ConfigEntry& e : keys) EXPECT_NE(e.path, before);
    const std::string told =
        before + " is " + now->path + " now; it is read as that for one version more";
    const std::string value = now->default_value;
    const Configuration file = configuration_from_text(nested(before, value), "f.yaml", {}, {});
    EXPECT_THAT(file.notices, ElementsAre("f.yaml:1: " + told));
    EXPECT_EQ(entry_of(file, now->path).where, "f.yaml:1");
    const std::string set = before + "=" + value;
    const Configuration setting = configuration_from_text("", "f.yaml", {}, {set});
    EXPECT_THAT(setting.notices, ElementsAre("--set " + set + ": " + told));
    EXPECT_EQ(entry_of(setting, now->path).where, "--set " + set);
  }
}

TEST(RenamedKeys, WhatIsLeftOfAMappingIsRead) {
  const Configuration c = configuration_from_text(
      "simulator:\n  camera:\n    odometry: {corners: {cells: 9,\n      border: 7}}\n"
      "    exposure: 2\nperception: {odometry: {corners: {min_strength_over_noise: 2}}}\n",
      "f.yaml", {}, {});
  EXPECT_EQ(c.notices.size(), 2u);
  EXPECT_EQ(entry_of(c, "perception.odometry.corners.cells").value, "9");
  EXPECT_EQ(entry_of(c, "perception.odometry.corners.border").where, "f.yaml:4");
  EXPECT_EQ(entry_of(c, "perception.odometry.corners.min_strength_over_noise").value, "2");
  EXPECT_EQ(entry_of(c, "simulator.camera.exposure").value, "2");
  EXPECT_THAT(refusals("drive: {perception: {}}", {}), IsEmpty());
}

TEST(RenamedKeys, OfBothNamesTheLaterSettingCounts) {
  const auto retreat = [](const std::string& yaml, const std::vector<YamlSetting>& settings) {
    return entry_of(configuration_from_text(yaml, "f.yaml", {}, settings),
                    "planner.recovery.retreat_time")
        .value;
  };
  EXPECT_EQ(retreat("planner: {recovery: {time: 3}}", {"planner.recovery.retreat_time=4"}), "4");
  EXPECT_EQ(retreat("planner: {recovery: {retreat_time: 3}}", {"planner.recovery.time=4"}), "4");
  EXPECT_EQ(retreat("", {"planner.recovery.time=4", "planner.recovery.retreat_time=5"}), "5");
  EXPECT_EQ(retreat("", {"planner.recovery.retreat_time=5", "planner.recovery.time=4"}), "4");
  EXPECT_EQ(retreat("planner: {recovery: {retreat_time: 3}}", {"planner={recovery: {time: 4}}"}),
            "4");
  EXPECT_THAT(
      refusals("planner:\n  recovery:\n    retreat_time: 3\n    time: 4", {}),
      ElementsAre("f.yaml:4: planner.recovery.time is planner.recovery.retreat_time now, and "
                  "f.yaml:3 tells that too; expected one of them"));
}

TEST(RenamedKeys, AWrongValueIsRefusedByTheNewName) {
  EXPECT_THAT(refusals("\nplanner: {recovery: {time: fast}}", {}),
              ElementsAre(StartsWith("f.yaml:2: planner.recovery.retreat_time: is 'fast'")));
}

TEST(GoneKeys, AreReadWithTheirDefaultAndRefusedWithAnother) {
  const std::vector<ConfigEntry> keys = read_configuration("").entries;
  for (const GoneKey& gone : gone_keys()) {
    for (const ConfigEntry& e : keys) EXPECT_NE(e.path, gone.before);
    EXPECT_THAT(refusals("", {gone.before + "=" + gone.value}), ElementsAre());
    EXPECT_THAT(refusals("", {gone.before + "=123"}),
                ElementsAre(StartsWith("--set " + gone.before + "=123: " + gone.before +
                                       " is no key any more: " + gone.why)));
  }
}

}  // namespace
}  // namespace prospect::renamed_keys_test
