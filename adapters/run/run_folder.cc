#include "adapters/run/run_folder.h"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <system_error>
#include <utility>

#include "adapters/files/input_error.h"
#include "adapters/files/whole_file.h"
#include "adapters/problem_file/problem_file.h"
#include "adapters/worlds/octree_file.h"
#include "models/range_text.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

std::string tum(double time, const Pose& p) {
  const double half = 0.5 * p.yaw;
  return exact_text(time) + ' ' + exact_text(p.position.x()) + ' ' + exact_text(p.position.y()) +
         ' ' + exact_text(p.position.z()) + " 0 0 " + exact_text(std::sin(half)) + ' ' +
         exact_text(std::cos(half)) + '\n';
}

constexpr const char* kProblems = "problems";

std::string problem_name(int step) {
  char name[32];
  std::snprintf(name, sizeof name, "step_%06d.h5", step);
  return name;
}

/// Removes the problem files of an earlier run, and their folder if nothing else is in it.
void remove_problems(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> old;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    int step = 0;
    const std::string name = entry.path().filename().string();
    if (std::sscanf(name.c_str(), "step_%d.h5", &step) == 1 && name == problem_name(step)) {
      old.push_back(entry.path());
    }
  }
  for (const fs::path& path : old) fs::remove(path, error);
  if (fs::is_directory(folder, error) && fs::is_empty(folder, error)) fs::remove(folder, error);
}

}  // namespace

RunFolder::RunFolder(const std::string& path, const RunStart& start) : path_(path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status)) {
    if (!fs::is_directory(status)) {
      throw InputError(path + ": not a folder; expected a folder for the run, or none");
    }
    const bool empty = fs::is_empty(path, error);
    if (error) {
      throw InputError(path + ": cannot be read (" + error.message() +
                       "); expected a readable folder");
    }
    if (!empty && !fs::is_regular_file(fs::path(path) / "steps.csv", error)) {
      throw InputError(path +
                       ": holds other files; expected an empty folder, an earlier run, or none");
    }
  } else if (fs::create_directories(path, error); error) {
    throw InputError(path + ": cannot be created (" + error.message() +
                     "); expected a writable place");
  }
  const auto unwritable = [&](const std::string& name, const std::string& reason) {
    return InputError(path + "/" + name + ": cannot be written (" + reason +
                      "); expected a writable folder");
  };
  lock_ = FileLock(path + "/steps.csv");
  if (lock_.busy()) {
    throw InputError(path + ": another run writes to it; expected a folder of its own (--out)");
  }
  if (!lock_.held()) throw unwritable("steps.csv", lock_.reason());
  const auto open = [&](RowFile& file, const char* name) {
    file = RowFile(path + "/" + name);
    if (!file.is_open()) throw unwritable(name, std::strerror(errno));
  };
  open(steps_, "steps.csv");
  open(timing_, "timing.csv");
  open(estimated_, "trajectory_estimated.tum");
  open(true_, "trajectory_true.tum");
  for (const char* name :
       {"summary.json", "config.yaml", "run.json", "map.bt", "report.html", "mission.mcap",
        "mission.html", "path.png", "path.svg", "map.png", "map.svg"}) {
    fs::remove(fs::path(path) / name, error);
  }
  remove_problems(fs::path(path) / kProblems);
  const auto begin_with = [&](const char* name, const std::string& content) {
    const std::string wrong = write_whole_file(path + "/" + name, content);
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
  append(timing_, "timing.csv", timing_row(step));
  append(estimated_, "trajectory_estimated.tum", tum(step.time, step.estimated_pose));
  append(true_, "trajectory_true.tum", tum(step.time, step.true_pose));
  waiting_.push_back(step);
  if (header_written_ || !step.explanation.terms.empty()) write_waiting();
}

void RunFolder::add(const SavedProblem& saved) {
  const fs::path folder = fs::path(path_) / kProblems;
  std::error_code error;
  fs::create_directories(folder, error);
  try {
    write_problem((folder / problem_name(saved.origin.step)).string(), saved);
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
  const std::string wrong = write_whole_file((fs::path(path_) / name).string(), content);
  if (!wrong.empty()) fail(name, wrong);
}

void RunFolder::finish(const RunRecord& record, const octomap::OcTree* map, const Page& page) {
  write_waiting();
  try {
    if (map) write_octree(*map, (fs::path(path_) / "map.bt").string());
  } catch (const std::exception& e) {
    if (error_.empty()) error_ = e.what();
  }
  try {
    write_whole("report.html", page(record));
  } catch (const std::exception& e) {
    fail("report.html", e.what());
  }
  // Last: its presence says that the run is complete.
  write_whole("summary.json", summary_json(record.summary));
}

}  // namespace prospect
