// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "adapters/formats/files/exit_code.h"
#include "adapters/formats/files/file_lock.h"

namespace prospect::study_run_test {
namespace {

namespace fs = std::filesystem;
using Status = CellRecord::Status;

/// A study of eight cells whose program is a script that behaves by seed.
class StudyRun : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = ::testing::TempDir() + "study_run_" +
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    plan_ = plan_study(study_from_text("worlds: office\nseeds: 1..8\n", "s.yaml"), {}, "1");
    options_.program = {folder_ + ".program"};
    options_.version = "1";
    options_.jobs = 3;
  }
  void TearDown() override {
    fs::remove_all(folder_);
    fs::remove(folder_ + ".program");
    fs::remove(folder_ + ".runs");
  }

  /// `what` sees $seed, and $out, the run folder, which is there.
  void program(const std::string& what) {
    std::ofstream(options_.program.front())
        << "#!/bin/bash\nwhile (($#)); do\n  case $1 in --seed) seed=$2;; --out) out=$2;; esac\n"
           "  shift\ndone\necho run >> " +
               folder_ + ".runs\nmkdir -p \"$out\"\n" + what + '\n';
    fs::permissions(options_.program.front(), fs::perms::owner_all);
  }
  static std::string whole(const std::string& reason = "time limit", int code = 1) {
    return "printf 'step,time\\n0,0\\n1,1\\n' > $out/steps.csv\n"
           "echo '{\"reason\": \"" +
           reason + "\", \"steps\": 2}' > $out/summary.json\nexit " + std::to_string(code) + '\n';
  }
  int runs() const {
    std::ifstream in(folder_ + ".runs");
    int count = 0;
    for (std::string line; std::getline(in, line);) ++count;
    return count;
  }
  CellRecord record(std::uint64_t seed) const {
    for (const StudyCell& cell : plan_.cells) {
      if (cell.seed == seed)
        return CellStore::existing(folder_, Study::Kind::kMissions).record(cell.id);
    }
    return {};
  }
  StudyRunResult run() {
    return run_study(plan_, CellStore(folder_, Study::Kind::kMissions), options_);
  }

  std::string folder_;
  StudyPlan plan_;
  StudyRunOptions options_;
};

TEST_F(StudyRun, RunsWhatIsNotThereAndNothingTwice) {
  program(whole());
  StudyRunResult result = run();
  EXPECT_EQ(result.ran, 8U);
  EXPECT_EQ(result.failed, 0U);
  result = run();
  EXPECT_EQ(result.there, 8U);
  EXPECT_EQ(result.ran, 0U);
  EXPECT_EQ(runs(), 8);
  EXPECT_EQ(record(3).status, Status::kDone);
  EXPECT_GT(record(3).wall_s, 0.0);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ + "/cells")) {
    const std::string extension = entry.path().extension().string();
    EXPECT_TRUE(extension.empty() || extension == ".json") << entry.path();
  }
}

TEST_F(StudyRun, ACrashAndARefusalAreFailedCellsUntilTheyAreTriedAgain) {
  program(
      "[[ $seed == 2 ]] && kill -SEGV $$\n[[ $seed == 5 ]] && { echo 'prospect: no way' >&2; "
      "exit 2; }\n" +
      whole());
  StudyRunResult result = run();
  EXPECT_EQ(result.ran, 6U);
  EXPECT_EQ(result.failed, 2U);
  EXPECT_THAT(record(2).why, ::testing::HasSubstr("signal 11"));
  EXPECT_EQ(record(5).why, "no way");
  result = run();
  EXPECT_EQ(result.failed, 2U);
  EXPECT_EQ(runs(), 8) << "a failed cell is not run again by itself";
  program(whole());
  options_.retry_failed = true;
  result = run();
  EXPECT_EQ(result.ran, 2U);
  EXPECT_EQ(result.failed, 0U);
}

TEST_F(StudyRun, WhatIsNotWholeIsRunAgain) {
  // A cancelled mission ends with a summary; so does one whose rows did not fit on the disk.
  program("if [[ $seed == 1 ]]; then\n" + whole("cancelled", kCancelled) +
          "fi\n[[ $seed == 2 ]] && kill -TERM "
          "$$\n" +
          whole());
  StudyRunResult result = run();
  EXPECT_EQ(result.broken_off, 2U);
  EXPECT_EQ(result.failed, 0U);
  EXPECT_EQ(record(1).status, Status::kMissing);
  program(whole());
  EXPECT_EQ(run().ran, 2U);
  // Killed before it was noted that a cell is done, a study goes by the run folder.
  const CellStore store(folder_, Study::Kind::kMissions);
  for (const StudyCell& cell : plan_.cells) {
    if (cell.seed == 3 || cell.seed == 4) fs::remove(store.path(cell.id, ".json"));
    if (cell.seed == 4) std::ofstream(store.run_folder(cell.id) + "/steps.csv") << "step\n0\n";
    if (cell.seed == 5) fs::remove(store.run_folder(cell.id) + "/summary.json");
  }
  EXPECT_EQ(record(3).status, Status::kDone);
  EXPECT_EQ(record(4).status, Status::kMissing) << "a row is missing";
  EXPECT_EQ(record(5).status, Status::kMissing) << "somebody has removed its summary";
  EXPECT_EQ(run().ran, 2U);
}

// A bench that is told to end before its first problem leaves nothing but its exit code.
TEST_F(StudyRun, ACellIsBrokenOffByItsExitCodeNotByItsWords) {
  program(
      "[[ $seed == 1 ]] && { echo 'prospect: enough' >&2; exit 4; }\n"
      "[[ $seed == 2 ]] && { echo 'prospect: cancelled by nobody' >&2; exit 1; }\n"
      "if [[ $seed == 3 ]]; then\n" +
      whole("cancelled") + "fi\n" + whole());
  const StudyRunResult result = run();
  EXPECT_EQ(result.broken_off, 1U);
  EXPECT_EQ(record(1).status, Status::kMissing);
  EXPECT_EQ(record(2).status, Status::kFailed);
  EXPECT_EQ(record(2).why, "cancelled by nobody");
  EXPECT_EQ(record(3).status, Status::kFailed);
  EXPECT_EQ(record(3).why, "exit code 1, the mission was cancelled");
}

TEST_F(StudyRun, AFullDiskIsNoFaultOfTheCell) {
  program("echo 'prospect: x/steps.csv: writing failed (No space left on device)' >&2\nexit 1\n");
  const StudyRunResult result = run();
  EXPECT_THAT(result.stopped, ::testing::HasSubstr("No space left"));
  EXPECT_EQ(result.failed, 0U);
  EXPECT_LE(runs(), 4) << "nothing more is begun";
  program(whole());
  EXPECT_EQ(run().ran, 8U);
}

TEST_F(StudyRun, CancelledItKillsAndGoesOnLater) {
  // In its own process, or it would hold the cell's lock until it, too, is gone.
  program("exec sleep 30\n");
  int asked = 0;
  options_.cancelled = [&] { return ++asked > 5; };
  StudyRunResult result = run();
  EXPECT_TRUE(result.cancelled);
  EXPECT_EQ(result.ran, 0U);
  program(whole());
  options_.cancelled = {};
  EXPECT_EQ(run().ran, 8U);
}

TEST_F(StudyRun, LeavesACellToWhoRunsIt) {
  program(whole());
  const CellStore store(folder_, Study::Kind::kMissions);
  const FileLock lock(store.path(plan_.cells[2].id, ".lock"));
  ASSERT_TRUE(lock.held());
  const StudyRunResult result = run();
  EXPECT_EQ(result.elsewhere, 1U);
  EXPECT_EQ(result.ran, 7U);
}

TEST_F(StudyRun, ShardsArePartsOfTheCells) {
  std::multiset<std::string> all;
  for (int n = 1; n <= 3; ++n) {
    for (const std::string& id : cells_of(plan_, {n, 3})) all.insert(id);
  }
  ASSERT_EQ(all.size(), 8U);
  for (const StudyCell& cell : plan_.cells) EXPECT_EQ(all.count(cell.id), 1U);
}

TEST_F(StudyRun, ExpectedTimesAreThoseOfCellsAlike) {
  const StudyPlan plan =
      plan_study(study_from_text("worlds: [office, corridor]\nseeds: 1..2\nconditions: {a: {}, b: "
                                 "{planner.N: 12}}\n",
                                 "s.yaml"),
                 {}, "1");
  ExpectedTimes times(plan);
  const auto id = [&](std::size_t world, std::size_t setup, std::uint64_t seed) {
    for (const StudyCell& cell : plan.cells) {
      if (cell.input == world && cell.setup == setup && cell.seed == seed) return cell.id;
    }
    return std::string();
  };
  EXPECT_TRUE(std::isnan(times.of(id(0, 0, 2))));
  times.add(id(0, 0, 1), 10.0);
  times.add(id(0, 1, 1), 20.0);
  EXPECT_EQ(times.of(id(0, 0, 2)), 10.0);
  EXPECT_EQ(times.of(id(0, 1, 2)), 20.0);
  EXPECT_EQ(times.of(id(1, 0, 1)), 15.0) << "of another world: of all";
}

}  // namespace
}  // namespace prospect::study_run_test
