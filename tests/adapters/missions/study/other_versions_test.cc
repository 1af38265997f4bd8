// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/other_versions.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>

#include "adapters/formats/files/content_hash.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/world_hash.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/run/run_start.h"

namespace prospect::other_versions_test {
namespace {

namespace fs = std::filesystem;

/// A study of four missions, and its cells as a program has run them.
class OtherVersions : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = ::testing::TempDir() + "other_versions_" +
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static StudyPlan plan(const std::string& program) {
    return plan_study(study_from_text("worlds: office\nseeds: 1..2\nstarts: drawn\n"
                                      "conditions: {with: {}, without: {planner.weights.w_l: 0}}\n",
                                      "s.yaml"),
                      {}, program);
  }
  /// `edit` may change the text of a configuration.
  void run(const StudyPlan& plan, const std::string& started,
           const std::function<void(std::string&)>& edit = {}) const {
    const CellStore store(folder_, Study::Kind::kMissions);
    for (const StudyCell& cell : plan.cells) {
      const std::string out = store.run_folder(cell.id);
      fs::create_directories(out);
      std::string configuration = cell_configuration(plan, cell);
      std::ofstream(out + "/config.yaml") << configuration;
      // As a mission reads it, with the start that is drawn.
      const std::uint64_t world = world_hash(
          load_world("office", world_options_for(read_configuration(out + "/config.yaml", {}))));
      if (edit) edit(configuration);
      std::ofstream(out + "/config.yaml") << configuration;
      RunStart start;
      start.world = "office";
      start.seed = cell.seed;
      start.world_hash = hash_text(world);
      std::ofstream(out + "/run.json") << start_json(start);
      std::ofstream(out + "/steps.csv") << "step,time\n0,0\n";
      std::ofstream(out + "/summary.json") << R"({"reason": "time limit", "steps": 1})";
      CellRecord record;
      record.status = CellRecord::Status::kDone;
      record.version = plan.program;
      record.started = started;
      store.write(cell.id, record);
    }
  }
  std::map<std::string, std::string> others(const StudyPlan& plan) const {
    return other_versions(plan, CellStore::existing(folder_, Study::Kind::kMissions), {});
  }

  std::string folder_;
};

TEST_F(OtherVersions, HaveRunTheSameMissions) {
  const StudyPlan now = plan("3"), before = plan("2"), first = plan("1");
  EXPECT_TRUE(others(now).empty()) << "nothing is stored";
  run(before, "2026-11-26T10:00:00Z");
  run(first, "2026-11-25T10:00:00Z");
  const std::map<std::string, std::string> found = others(now);
  ASSERT_EQ(found.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(found.at(now.cells[i].id), before.cells[i].id) << "the newest counts, of cell " << i;
  }
  run(now, "2026-11-27T10:00:00Z");
  EXPECT_EQ(others(now), found) << "cells of this version stand for none";
}

TEST_F(OtherVersions, AKeyThatWasNotThereHasItsDefault) {
  const StudyPlan now = plan("2"), before = plan("1");
  run(before, "", [](std::string& text) {
    const std::size_t at = text.find("  N: 20");
    ASSERT_NE(at, std::string::npos);
    text.erase(at, text.find('\n', at) + 1 - at);
  });
  EXPECT_EQ(others(now).size(), 4U);
}

TEST_F(OtherVersions, AnotherMissionStandsForNone) {
  const StudyPlan now = plan("2"), before = plan("1");
  run(before, "", [](std::string& text) { text.replace(text.find("  N: 20"), 7, "  N: 21"); });
  EXPECT_TRUE(others(now).empty());
  run(before, "", [](std::string& text) { text += "a_key_of_old: 1\n"; });
  EXPECT_TRUE(others(now).empty()) << "a configuration that is not taken today";
  run(before, "");
  EXPECT_EQ(others(now).size(), 4U);
  fs::remove(folder_ + "/cells/" + before.cells[0].id + "/summary.json");
  EXPECT_EQ(others(now).size(), 3U) << "one is not whole";
}

}  // namespace
}  // namespace prospect::other_versions_test
