// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/run_folder.h"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/problem_file/problem_file.h"
#include "adapters/formats/worlds/octree_file.h"
#include "models/range_text.h"
#include "runtime/mission_end.h"

namespace prospect {
namespace {

std::string tum(double time, const Pose& p) {
  const double half = 0.5 * p.yaw;
  return exact_text(time) + ' ' + exact_text(p.position.x()) + ' ' + exact_text(p.position.y()) +
         ' ' + exact_text(p.position.z()) + " 0 0 " + exact_text(std::sin(half)) + ' ' +
         exact_text(std::cos(half)) + '\n';
}

std::string problem_name(int step) {
  char name[48];
  std::snprintf(name, sizeof name, "problems/step_%06d.h5", step);
  return name;
}

constexpr const char* kRun = "run";
constexpr const char* kDrive = "drive";

}  // namespace

RunFolder::RunFolder(const std::string& path, const RunStart& start, EarlierDrive earlier)
    : path_(path),
      folder_(OutputFolder::own(path, start.real_time ? std::vector<std::string>{kDrive, kRun}
                                                      : std::vector<std::string>{kRun, kDrive})) {
  if (folder_.kind() == kDrive && folder_.state() != OutputFolder::State::kNew &&
      earlier == EarlierDrive::kRefused) {
    throw InputError(path +
                     ": holds a drive, which nothing can repeat; expected another folder (--out), "
                     "or --overwrite");
  }
  folder_.begin({"steps.csv", "timing.csv", "trajectory_estimated.tum", "trajectory_true.tum",
                 "config.yaml", "run.json", "summary.json", "map.bt", "report.html"});
  try {
    begin(start);
  } catch (...) {
    folder_.abandon();
    throw;
  }
}

RunFolder::~RunFolder() {
  if (!holds_steps_) folder_.abandon();
}

void RunFolder::begin(const RunStart& start) {
  const auto unwritable = [&](const std::string& name, const std::string& reason) {
    return InputError(path_ + "/" + name + ": cannot be written (" + reason +
                      "); expected a writable folder");
  };
  const auto open = [&](RowFile& file, const char* name) {
    file = RowFile(path_ + "/" + name);
    if (!file.is_open()) throw unwritable(name, std::strerror(errno));
  };
  open(steps_, "steps.csv");
  open(timing_, "timing.csv");
  open(estimated_, "trajectory_estimated.tum");
  open(true_, "trajectory_true.tum");
  const auto begin_with = [&](const char* name, const std::string& content) {
    const std::string wrong = folder_.write(name, content);
    if (!wrong.empty()) throw unwritable(name, wrong);
  };
  begin_with("config.yaml", start.configuration);
  begin_with("run.json", start_json(start));
  append(timing_, "timing.csv", timing_header());
}

void RunFolder::fail(const std::string& name, const std::string& reason) {
  if (error_.empty()) error_ = path_ + "/" + name + ": writing failed (" + reason + ")";
}

void RunFolder::append(RowFile& file, const char* name, const std::string& row) {
  if (!file.append(row)) fail(name, std::strerror(errno));
}

void RunFolder::add(const StepRecord& step) {
  holds_steps_ = true;
  append(timing_, "timing.csv", timing_row(step));
  append(estimated_, "trajectory_estimated.tum", tum(step.time, step.estimated_pose));
  append(true_, "trajectory_true.tum", tum(step.time, step.true_pose));
  waiting_.push_back(step);
  if (header_written_ || !step.explanation.terms.empty()) write_waiting();
}

void RunFolder::add(const SavedProblem& saved) {
  try {
    write_problem(folder_.claim(problem_name(saved.origin.step)), saved);
  } catch (const std::exception& e) {
    if (error_.empty()) error_ = e.what();
  }
}

void RunFolder::write_waiting() {
  if (!header_written_) {
    columns_ = step_columns(waiting_);
    append(steps_, "steps.csv", step_header(columns_));
    header_written_ = true;
  }
  for (const StepRecord& s : waiting_) append(steps_, "steps.csv", step_row(s, columns_));
  waiting_.clear();
}

void RunFolder::write_whole(const std::string& name, const std::string& content) {
  const std::string wrong = folder_.write(name, content);
  if (!wrong.empty()) fail(name, wrong);
}

void RunFolder::finish(const RunRecord& record, const octomap::OcTree* map, const Page& page) {
  holds_steps_ = true;
  write_waiting();
  const auto guarded = [&](const char* name, const auto& write) {
    try {
      write();
    } catch (const InputError& e) {
      if (error_.empty()) error_ = e.what();  // names the file
    } catch (const std::exception& e) {
      fail(name, e.what());
    }
  };
  if (map) guarded("map.bt", [&] { write_octree(*map, folder_.claim("map.bt")); });
  guarded("report.html", [&] { write_whole("report.html", page(record)); });
  // Last: its presence says that the mission came to an end.
  guarded("summary.json", [&] { write_whole("summary.json", summary_json(record.summary)); });
  const bool whole = error_.empty() && record.summary.end != MissionEnd::kCancelled;
  if (const std::string wrong = whole ? folder_.complete() : ""; !wrong.empty()) {
    fail(OutputFolder::kMarker, wrong);
  }
}

}  // namespace prospect
