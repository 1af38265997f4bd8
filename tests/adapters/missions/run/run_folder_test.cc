// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/run_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/octree_file.h"
#include "adapters/views/report/report.h"
#include "tests/adapters/synthetic_run.h"

namespace prospect::run_folder_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

class RunFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    root_ = testing::TempDir() + "run_folder_" + std::to_string(getpid());
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }
  std::string path(const std::string& name) const { return root_ + "/" + name; }

  std::string root_;
};

std::string content(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// Every file below a folder, with its bytes.
std::map<std::string, std::string> tree(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    files[fs::relative(entry.path(), folder)] = entry.is_directory() ? "" : content(entry.path());
  }
  return files;
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

/// Fields of one CSV line (RFC 4180 without line breaks in fields).
std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"') {
        result.back() += line[++i];
      } else {
        quoted = !quoted;
      }
    } else if (line[i] == ',' && !quoted) {
      result.emplace_back();
    } else {
      result.back() += line[i];
    }
  }
  return result;
}

RunStart begun() {
  RunStart start;
  start.world = "office";
  start.solver = "nlopt";
  start.seed = 18446744073709551615ULL;
  start.command_line = "prospect explore \xff";
  start.version = "1.2.3";
  start.started = "2026-11-26T17:02:11Z";
  start.configuration = "robot:\n  model: unicycle\n";
  return start;
}

std::string refusal(const std::string& path) {
  try {
    RunFolder folder(path, begun());
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1U);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

StepRecord plain_step() {
  StepRecord s;
  s.step = 3;
  s.time = 1.5;
  s.true_pose = {{1.25, -2.0, 0.0}, 0.1};
  s.estimated_pose = {{1.5, -2.5, 0.125}, M_PI};
  s.command = {{0.4, 0.0, 0.0}, -0.3};
  s.plan_kind = PlanKind::kOptimised;
  s.seed = "tail";
  s.explanation = {
      7.5, 0.0, {{"control_effort", "", 2.0, 4.0, false}, {"clearance", "m", 0.1, 0.0, true}}};
  s.weights = {{"control_effort", 2.5, 2.0}};
  s.predicted_features = 41.5;
  s.tracked_features = 39;
  s.localization = Localization::kOk;
  s.coverage = 0.25;
  s.area = 12.5;
  s.localization_error = 0.0625;
  s.path_length = 8.0;
  s.clearance = 0.3;
  s.cost_evaluations = 90;
  s.gradient_evaluations = 30;
  s.stop_reason = StopReason::kConverged;
  s.quality = Quality::kFeasibleOptimum;
  s.certified = true;
  s.certificate = "clear, 0.21 m \"or more\"\nall along";
  s.active_frontiers = 2;
  s.frontiers = "1.20 m2 in 8.4 s at 1.00 2.00; 3 little";
  s.guard_stops = 1;
  s.guard_reason = GuardReason::kMap;
  s.mode = ModeKind::kApproach;
  s.cause = Cause::kNoProgress;
  s.mode_since = 1.25;
  s.safety_level = SafetyLevel::kNormal;
  s.target_change = TargetChange::kSeen;
  s.task = TaskKind::kGoTo;
  s.goal = Eigen::Vector2d(4.5, -0.25);
  s.why = "Approaches, since nothing else helped.";
  s.target = TargetRecord{{2.0, -1.5}, {3.5, -1.0}, 0.75, 0.25, 1.125};
  s.seeds_scored = 26;
  s.features_weight = 1.5;
  s.candidates = {{"arc", false, {Verdict::Kind::kRefused, "would touch"}, {1.25, 0.0, {}}, {}},
                  {"tail", true, {Verdict::Kind::kExecuted}, {7.5, 0.0, {}}, {}},
                  {"turn", false, {}, {8.0, 0.0, {}}, {}}};
  return s;
}

TEST_F(RunFolderTest, WritesAStepByHand) {
  {
    RunFolder folder(path("run"), begun());
    folder.add(plain_step());
    EXPECT_EQ(folder.error(), "");
  }
  EXPECT_EQ(
      content(path("run/steps.csv")),
      "step,time,true_x,true_y,true_yaw,estimated_x,estimated_y,estimated_yaw,command_v,"
      "command_vy,command_omega,plan_kind,seed,cost,violation,term_control_effort,"
      "term_clearance,predicted_features,tracked_features,localization,localization_error,"
      "coverage,area,path_length,collisions,clearance,cost_evaluations,"
      "gradient_evaluations,stop_reason,quality,certified,active_frontiers,frontiers,"
      "guard_stops,guard_reason,task,goal_x,goal_y,goal_yaw,mode,cause,mode_since,caution,target_"
      "change,target_x,target_y,"
      "looks_x,looks_y,target_length,target_area,way_left,seeds_scored,features_weight,rejected,"
      "weight_asked_control_effort,weight_control_effort,certificate,why\n"
      "3,1.5,1.25,-2,0.1,1.5,-2.5,3.141592653589793,0.4,0,-0.3,optimised,tail,7.5,0,2,0.1,"
      "41.5,39,ok,0.0625,0.25,12.5,8,0,0.3,90,30,converged,feasible optimum,1,"
      "2,1.20 m2 in 8.4 s at 1.00 2.00; 3 little,1,map,go to,4.5,-0.25,,approach,no "
      "progress,1.25,normal,seen,2,-1.5,3.5,-1,"
      "0.75,0.25,1.125,26,1.5,arc 1.25 refused; turn 8 not tried,"
      "2.5,2,\"clear, 0.21 m \"\"or more\"\" all along\","
      "\"Approaches, since nothing else helped.\"\n");
  EXPECT_EQ(content(path("run/trajectory_true.tum")),
            "1.5 1.25 -2 0 0 0 0.04997916927067833 0.9987502603949663\n")
      << "sin and cos of half of 0.1 rad";
  EXPECT_THAT(content(path("run/trajectory_estimated.tum")),
              StartsWith("1.5 1.5 -2.5 0.125 0 0 1 "));
}

TEST_F(RunFolderTest, StepsAreTheSameBytesWhateverTheClockSays) {
  RunRecord run = synthetic_run(40);
  const auto write = [&](const std::string& name) {
    RunFolder folder(path(name), begun());
    for (const StepRecord& s : run.steps) folder.add(s);
    folder.finish(run, nullptr, render_report);
    EXPECT_EQ(folder.error(), "");
  };
  write("a");
  for (StepRecord& s : run.steps) s.wall = {99.0, 98.0, 97.0, 96.0, 95.0, 94.0, 93.0};
  write("b");
  for (const char* name : {"steps.csv", "trajectory_true.tum", "trajectory_estimated.tum"}) {
    EXPECT_EQ(content(path("a/") + name), content(path("b/") + name)) << name;
  }
  EXPECT_NE(content(path("a/timing.csv")), content(path("b/timing.csv")));
  EXPECT_EQ(lines(content(path("b/timing.csv")))[40],
            "39,99.000,98.000,97.000,96.000,95.000,94.000,93.000,0.000,0.000,0.000");
}

TEST_F(RunFolderTest, EveryRowHasEveryColumn) {
  RunRecord run = synthetic_run(130);
  run.steps[0].explanation = {};  // no plan yet: the columns are not known
  run.steps[1].explanation = {};
  run.steps[70].explanation = {};
  run.steps[71].explanation.terms.pop_back();
  run.steps[72].explanation.terms.push_back({"appears_late", "", 1.0, 1.0, false});
  run.steps[73].explanation.terms.push_back(run.steps[73].explanation.terms[0]);
  run.steps[74].predicted_features = std::nan("");
  run.steps[75].clearance = std::numeric_limits<double>::infinity();
  RunFolder folder(path("run"), begun());
  folder.add(run.steps[0]);
  folder.add(run.steps[1]);
  EXPECT_EQ(content(path("run/steps.csv")), "");
  EXPECT_EQ(lines(content(path("run/trajectory_true.tum"))).size(), 2U) << "these need not wait";
  for (std::size_t k = 2; k < run.steps.size(); ++k) folder.add(run.steps[k]);

  const std::vector<std::string> rows = lines(content(path("run/steps.csv")));
  ASSERT_EQ(rows.size(), 131U);
  const std::vector<std::string> header = fields(rows[0]);
  const auto value = [&](int step, const std::string& name) {
    const auto at = std::find(header.begin(), header.end(), name);
    EXPECT_NE(at, header.end()) << name;
    return fields(rows[static_cast<std::size_t>(step) + 1])
        .at(static_cast<std::size_t>(at - header.begin()));
  };
  for (const std::string& row : rows) EXPECT_EQ(fields(row).size(), header.size()) << row;
  for (int k = 0; k < 130; ++k) EXPECT_EQ(value(k, "step"), std::to_string(k));
  EXPECT_EQ(value(0, "term_control_effort"), "");
  EXPECT_EQ(value(0, "cost"), "");
  EXPECT_EQ(value(70, "cost"), "");
  EXPECT_EQ(value(71, "term_clearance"), "");
  EXPECT_EQ(value(73, "term_control_effort"), "0.8") << "once, though the term is there twice";
  EXPECT_EQ(value(74, "predicted_features"), "nan");
  EXPECT_EQ(value(75, "clearance"), "inf");
  EXPECT_EQ(value(2, "term_exploration_gain"), "-2") << "raw, not weighted";
}

TEST_F(RunFolderTest, AKillLeavesWholeRows) {
  const RunRecord run = synthetic_run(30);
  const pid_t child = fork();
  if (child == 0) {
    RunFolder folder(path("run"), begun());
    for (;;) {
      for (const StepRecord& s : run.steps) folder.add(s);
    }
  }
  // Well into the writing: some thousand rows.
  for (int i = 0; i < 2000; ++i) {
    std::error_code error;
    const auto size = fs::file_size(path("run/steps.csv"), error);
    if (!error && size > 1000000) break;
    usleep(5000);
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  for (const char* name : {"steps.csv", "timing.csv", "trajectory_true.tum"}) {
    const std::string text = content(path("run/") + name);
    ASSERT_GT(text.size(), 10000U) << name;
    EXPECT_EQ(text.back(), '\n') << name;
  }
  const std::vector<std::string> rows = lines(content(path("run/steps.csv")));
  EXPECT_EQ(fields(rows.back()).size(), fields(rows[0]).size());
  EXPECT_FALSE(fs::exists(path("run/summary.json"))) << "its presence says that a run is complete";
}

TEST_F(RunFolderTest, FinishWritesTheRest) {
  const RunRecord run = synthetic_run(20);
  octomap::OcTree map(0.1);
  map.updateNode(octomap::point3d(1.0F, 2.0F, 0.5F), true);
  RunFolder folder(path("deep/er/run"), begun());
  for (const StepRecord& s : run.steps) folder.add(s);
  folder.finish(run, &map, render_report);
  EXPECT_EQ(folder.error(), "");
  std::vector<std::string> names;
  for (const auto& [name, bytes] : tree(path("deep/er/run"))) names.push_back(name);
  EXPECT_THAT(names, testing::ElementsAre(".prospect", "config.yaml", "map.bt", "report.html",
                                          "run.json", "steps.csv", "summary.json", "timing.csv",
                                          "trajectory_estimated.tum", "trajectory_true.tum"));
  const auto summary = nlohmann::json::parse(content(path("deep/er/run/summary.json")));
  EXPECT_EQ(summary["steps"], 20);
  const auto again = read_octree(path("deep/er/run/map.bt"));
  ASSERT_NE(again->search(1.0, 2.0, 0.5), nullptr);
  EXPECT_TRUE(again->isNodeOccupied(again->search(1.0, 2.0, 0.5)));
}

TEST_F(RunFolderTest, AMissionWithoutAPlanStillHasItsRows) {
  RunRecord run;
  run.steps.resize(2);
  run.steps[1].step = 1;
  RunFolder folder(path("run"), begun());
  for (const StepRecord& s : run.steps) folder.add(s);
  folder.finish(run, nullptr, render_report);
  EXPECT_EQ(lines(content(path("run/steps.csv"))).size(), 3U);
  EXPECT_EQ(folder.error(), "");
}

TEST_F(RunFolderTest, TakesTheFolderOfAnEarlierRun) {
  const RunRecord run = synthetic_run(5);
  {
    RunFolder folder(path("run"), begun());
    for (const StepRecord& s : run.steps) folder.add(s);
    folder.finish(run, nullptr, render_report);
  }
  std::ofstream(path("run/notes.txt")) << "mine";
  { const RunFolder without_a_step(path("run"), begun()); }
  RunFolder folder(path("run"), begun());
  folder.add(run.steps[0]);
  EXPECT_EQ(lines(content(path("run/steps.csv"))).size(), 2U);
  EXPECT_FALSE(fs::exists(path("run/summary.json"))) << "the old one belongs to another run";
  EXPECT_FALSE(fs::exists(path("run/report.html")));
  EXPECT_EQ(content(path("run/notes.txt")), "mine");
}

TEST_F(RunFolderTest, ADriveIsNotWrittenOverUnasked) {
  RunStart drive = begun();
  drive.real_time = true;
  { RunFolder(path("run"), drive).add(plain_step()); }
  const auto before = tree(root_);
  EXPECT_THAT(refusal(path("run")), HasSubstr("holds a drive, which nothing can repeat; expected"));
  EXPECT_THROW(RunFolder(path("run"), drive), InputError);
  EXPECT_EQ(tree(root_), before);
  RunFolder folder(path("run"), begun(), RunFolder::EarlierDrive::kReplaced);
  folder.add(plain_step());
  EXPECT_EQ(lines(content(path("run/steps.csv"))).size(), 2U);
}

TEST_F(RunFolderTest, RefusesAForeignFolderAndLeavesItAlone) {
  fs::create_directories(path("home/photos"));
  std::ofstream(path("home/steps.csv")) << "my own";
  std::ofstream(path("home/map.png")) << "precious";
  const auto before = tree(root_);
  EXPECT_THAT(refusal(path("home")), StartsWith(path("home") + ": holds other files; expected"));
  EXPECT_EQ(tree(root_), before);
}

TEST_F(RunFolderTest, RefusesAPlaceWithoutWritePermission) {
  EXPECT_THAT(refusal("/proc/run"), AllOf(StartsWith("/proc/run: cannot be created ("),
                                          EndsWith("); expected a writable place")));
}

/// So many bytes at most in any file of this process, or so many open files, while it is there.
class Limit {
 public:
  Limit(__rlimit_resource_t of, rlim_t most) : of_(of) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(of_, &before_);
    const rlimit now{most, before_.rlim_max};
    setrlimit(of_, &now);
  }
  ~Limit() { setrlimit(of_, &before_); }
  Limit(const Limit&) = delete;
  Limit& operator=(const Limit&) = delete;

 private:
  const __rlimit_resource_t of_;
  rlimit before_{};
};

TEST_F(RunFolderTest, AFullDiskIsReportedOnceAndTheRestIsWritten) {
  const RunRecord run = synthetic_run(10);
  RunFolder folder(path("run"), begun());
  {
    const Limit full(RLIMIT_FSIZE, 1500);
    for (const StepRecord& s : run.steps) folder.add(s);
    folder.finish(run, nullptr, render_report);
  }
  EXPECT_EQ(folder.error(), path("run/steps.csv") + ": writing failed (File too large)");
  EXPECT_EQ(lines(content(path("run/timing.csv"))).size(), 11U);
  EXPECT_EQ(content(path("run/steps.csv")).back(), '\n');
  EXPECT_FALSE(fs::exists(path("run/report.html")));
  EXPECT_FALSE(fs::exists(path("run/report.html.part")));
  EXPECT_THAT(content(path("run/.prospect")), testing::Not(HasSubstr("complete")));
}

TEST_F(RunFolderTest, AFileAtTheEndAppearsWholeOrNotAtAll) {
  const RunRecord run = synthetic_run(3);
  {
    RunFolder folder(path("run"), begun());
    fs::create_directories(path("run/report.html/in the way"));
    folder.finish(run, nullptr, render_report);
    EXPECT_THAT(folder.error(), AllOf(StartsWith(path("run/report.html") + ": is no regular file"),
                                      testing::Not(HasSubstr("\n"))));
    EXPECT_TRUE(fs::exists(path("run/summary.json")));
    EXPECT_FALSE(fs::exists(path("run/report.html.part")));
  }
  RunFolder folder(path("linked"), begun());
  std::ofstream(path("theirs")) << "precious";
  fs::create_symlink(path("theirs"), path("linked/summary.json.part"));
  folder.finish(run, nullptr, render_report);
  EXPECT_THAT(folder.error(), HasSubstr("summary.json.part: is no regular file"));
  EXPECT_EQ(content(path("theirs")), "precious");
}

TEST_F(RunFolderTest, WhatCannotBeginLeavesNothing) {
  {
    const Limit full(RLIMIT_FSIZE, 0);
    EXPECT_THAT(refusal(path("run")), HasSubstr("cannot be written (File too large)"));
  }
  EXPECT_FALSE(fs::exists(path("run")));
  int refused = 0;
  for (bool enough = false; !enough && refused < 20;) {
    const int next = dup(0);
    close(next);
    const Limit few(RLIMIT_NOFILE, static_cast<rlim_t>(next + refused));
    enough = refusal(path("run")).empty();
    refused += !enough;
    EXPECT_FALSE(fs::exists(path("run"))) << refused;
  }
  EXPECT_GT(refused, 5) << "marker, lock, four tables, one at a time";
  { const RunFolder folder(path("run"), begun()); }
  EXPECT_FALSE(fs::exists(path("run"))) << "of a mission that never made a step";
}

TEST_F(RunFolderTest, WhatItWasStartedWithIsThereFromTheStart) {
  const RunFolder folder(path("run"), begun());
  EXPECT_EQ(content(path("run/config.yaml")), begun().configuration);
  const auto start = nlohmann::json::parse(content(path("run/run.json")));
  EXPECT_EQ(start["world"], "office");
  EXPECT_EQ(start["seed"], 18446744073709551615ULL);
  EXPECT_EQ(start["command_line"], "prospect explore \xef\xbf\xbd");
  EXPECT_EQ(start["version"], "1.2.3");
  EXPECT_EQ(start["real_time"], false);
  EXPECT_EQ(utc_now().size(), begun().started.size());
}

TEST_F(RunFolderTest, OneRunAtATime) {
  {
    RunFolder folder(path("run"), begun());
    folder.add(plain_step());
    const auto before = tree(root_);
    EXPECT_EQ(refusal(path("run")),
              path("run") + ": another run writes to it; expected a folder of its own (--out)");
    EXPECT_EQ(tree(root_), before);
  }
  EXPECT_EQ(refusal(path("run")), "") << "the lock ends with the run";
}

}  // namespace
}  // namespace prospect::run_folder_test
