#include "adapters/missions/config/renamed_keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/config/configuration.h"

namespace prospect::renamed_keys_test {
namespace {

using ::testing::ElementsAre;
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

/// "a.b.c" as "a: {b: {c: 1}}".
std::string nested(std::string key) {
  std::string end = ": 1";
  for (std::size_t dot; (dot = key.find('.')) != std::string::npos;) {
    key = key.substr(0, dot) + ": {" + key.substr(dot + 1);
    end += '}';
  }
  return key + end;
}

TEST(RenamedKeys, EachIsRefusedWithTheNameItHasNow) {
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
    const std::string told = before + " is " + now->path + " now; expected that";
    EXPECT_THAT(refusals(nested(before), {}), ElementsAre("f.yaml:1: " + told));
    EXPECT_THAT(refusals("", {before + "=1"}), ElementsAre("--set " + before + "=1: " + told));
  }
}

TEST(RenamedKeys, WhatIsLeftOfAMappingIsRead) {
  EXPECT_THAT(
      refusals("simulator:\n  camera:\n    odometry: {corners: {cells: 9,\n      border: 1}}\n"
               "    exposure: 200\n",
               {}),
      ElementsAre(
          "f.yaml:3: simulator.camera.odometry.corners.cells is perception.odometry.corners.cells "
          "now; expected that",
          "f.yaml:4: simulator.camera.odometry.corners.border is "
          "perception.odometry.corners.border now; expected that",
          StartsWith("f.yaml:5: simulator.camera.exposure: is '200'")));
  EXPECT_THAT(refusals("drive: {perception: {}}", {}),
              ElementsAre("f.yaml:1: drive.perception is perception now; expected that"));
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
