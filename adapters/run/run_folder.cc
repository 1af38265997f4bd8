#include "adapters/run/run_folder.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "adapters/config/input_error.h"
#include "adapters/report/report.h"
#include "adapters/worlds/octree_file.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

/// The shortest text that reads back as the same number.
std::string text(double value) {
  char buffer[64];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return error == std::errc() ? std::string(buffer, end) : "nan";
}

/// A CSV field: quoted if it must be.
std::string field(const std::string& value) {
  if (value.find_first_of(",\"\n") == std::string::npos) return value;
  std::string quoted = "\"";
  for (const char c : value) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + '"';
}

std::string tum(double time, const Pose& p) {
  const double half = 0.5 * p.yaw;
  return text(time) + ' ' + text(p.position.x()) + ' ' + text(p.position.y()) + ' ' +
         text(p.position.z()) + " 0 0 " + text(std::sin(half)) + ' ' + text(std::cos(half)) + '\n';
}

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

RunFolder::RunFolder(const std::string& path) : path_(path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status)) {
    if (!fs::is_directory(status)) {
      throw InputError(path + ": not a folder; expected a folder for the run, or none");
    }
    if (!fs::is_empty(path, error) && !fs::exists(fs::path(path) / "steps.csv", error)) {
      throw InputError(path +
                       ": holds other files; expected an empty folder, an earlier run, or none");
    }
  } else if (fs::create_directories(path, error); error) {
    throw InputError(path + ": cannot be created (" + error.message() +
                     "); expected a writable place");
  }
  for (const char* name : {"summary.json", "config.yaml", "map.bt", "report.html"}) {
    fs::remove(fs::path(path) / name, error);
  }
  const auto open = [&](std::ofstream& file, const char* name) {
    file.open(fs::path(path) / name, std::ios::trunc);
    if (!file) {
      throw InputError(path + "/" + name + ": cannot be written; expected a writable folder");
    }
  };
  open(steps_, "steps.csv");
  open(timing_, "timing.csv");
  open(estimated_, "trajectory_estimated.tum");
  open(true_, "trajectory_true.tum");
  timing_ << "step,plan_ms,guide_ms,clearance_ms,views_ms,seeds_ms,polish_ms,certify_ms\n";
}

void RunFolder::check(std::ofstream& file, const std::string& name) {
  file.flush();
  if (file) return;
  if (error_.empty()) error_ = path_ + "/" + name + ": writing failed; the disk may be full";
  file.clear();
}

void RunFolder::add(const StepRecord& step) {
  waiting_.push_back(step);
  if (header_written_ || !step.explanation.terms.empty()) write_waiting();
}

void RunFolder::write_waiting() {
  if (!header_written_) {
    for (const StepRecord& s : waiting_) {
      if (!terms_.empty()) break;
      for (const TermValue& t : s.explanation.terms) terms_.push_back(t.name);
    }
    steps_ << "step,time,true_x,true_y,true_yaw,estimated_x,estimated_y,estimated_yaw,"
              "command_v,command_vy,command_omega,plan_kind,seed,cost,violation";
    for (const std::string& t : terms_) steps_ << ",term_" << t;
    steps_ << ",predicted_features,tracked_features,localization,localization_error,coverage,area,"
              "path_length,collisions,clearance,cost_evaluations,gradient_evaluations,stop_reason,"
              "quality,certified,certificate,active_frontiers,guard_stops\n";
    header_written_ = true;
  }
  for (const StepRecord& s : waiting_) write_row(s);
  waiting_.clear();
}

void RunFolder::write_row(const StepRecord& s) {
  std::string row = std::to_string(s.step) + ',' + text(s.time);
  for (const Pose* p : {&s.true_pose, &s.estimated_pose}) {
    row += ',' + text(p->position.x()) + ',' + text(p->position.y()) + ',' + text(p->yaw);
  }
  row += ',' + text(s.command.linear.x()) + ',' + text(s.command.linear.y()) + ',' +
         text(s.command.yaw_rate) + ',' + field(s.plan_kind) + ',' + field(s.seed);
  const bool explained = !s.explanation.terms.empty();
  row += ',' + (explained ? text(s.explanation.cost) : "") + ',' +
         (explained ? text(s.explanation.violation) : "");
  for (const std::string& name : terms_) {
    row += ',';
    for (const TermValue& t : s.explanation.terms) {
      if (t.name == name) row += text(t.raw);
    }
  }
  row += ',' + text(s.predicted_features) + ',' + std::to_string(s.tracked_features) + ',' +
         s.localization + ',' + text(s.localization_error) + ',' + text(s.coverage) + ',' +
         text(s.area) + ',' + text(s.path_length) + ',' + std::to_string(s.collisions) + ',' +
         text(s.clearance) + ',' + std::to_string(s.cost_evaluations) + ',' +
         std::to_string(s.gradient_evaluations) + ',' + field(s.stop_reason) + ',' +
         field(s.quality) + ',' + (s.certified ? "1" : "0") + ',' + field(s.certificate) + ',' +
         std::to_string(s.active_frontiers) + ',' + std::to_string(s.guard_stops) + '\n';
  steps_ << row;
  check(steps_, "steps.csv");
  timing_ << s.step << ',' << s.wall.plan << ',' << s.wall.guide << ',' << s.wall.clearance << ','
          << s.wall.views << ',' << s.wall.seeds << ',' << s.wall.polish << ',' << s.wall.certify
          << '\n';
  check(timing_, "timing.csv");
  estimated_ << tum(s.time, s.estimated_pose);
  check(estimated_, "trajectory_estimated.tum");
  true_ << tum(s.time, s.true_pose);
  check(true_, "trajectory_true.tum");
}

void RunFolder::write_whole(const std::string& name, const std::string& content) {
  const fs::path target = fs::path(path_) / name;
  fs::path temporary = target;
  temporary += ".part";
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  file << content;
  file.close();
  std::error_code error;
  if (file) fs::rename(temporary, target, error);
  if (!file || error) {
    if (error_.empty()) error_ = target.string() + ": writing failed; the disk may be full";
    fs::remove(temporary, error);
  }
}

void RunFolder::finish(const RunRecord& record, const octomap::OcTree* map) {
  write_waiting();
  write_whole("config.yaml", record.configuration);
  if (map) {
    try {
      write_octree(*map, (fs::path(path_) / "map.bt").string());
    } catch (const std::exception& e) {
      if (error_.empty()) error_ = e.what();
    }
  }
  write_whole("report.html", render_report(record));
  // Last: its presence says that the run is complete.
  write_whole("summary.json", summary_json(record.summary));
}

std::string summary_json(const Summary& s) {
  const nlohmann::ordered_json json = {{"world", s.world},
                                       {"solver", s.solver},
                                       {"seed", s.seed},
                                       {"reason", s.reason},
                                       {"coverage", number(s.coverage)},
                                       {"area_m2", number(s.area_m2)},
                                       {"reachable_area_m2", number(s.reachable_area_m2)},
                                       {"collisions", s.collisions},
                                       {"losses", s.losses},
                                       {"duration_s", number(s.duration_s)},
                                       {"wall_s", number(s.wall_s)},
                                       {"path_length_m", number(s.path_length_m)},
                                       {"time_to_90_s", number(s.time_to_90_s)},
                                       {"time_to_95_s", number(s.time_to_95_s)},
                                       {"time_to_99_s", number(s.time_to_99_s)},
                                       {"path_to_90_m", number(s.path_to_90_m)},
                                       {"path_to_95_m", number(s.path_to_95_m)},
                                       {"path_to_99_m", number(s.path_to_99_m)},
                                       {"localization_rmse_m", number(s.localization_rmse_m)},
                                       {"localization_final_m", number(s.localization_final_m)},
                                       {"drift_percent", number(s.drift_percent)},
                                       {"plan_ms",
                                        {{"p50", number(s.plan_ms_p50)},
                                         {"p95", number(s.plan_ms_p95)},
                                         {"p99", number(s.plan_ms_p99)},
                                         {"max", number(s.plan_ms_max)}}},
                                       {"deadline_misses", s.deadline_misses},
                                       {"fallbacks", s.fallbacks},
                                       {"guard_stops", s.guard_stops},
                                       {"steps", s.steps}};
  return json.dump(2) + '\n';
}

}  // namespace prospect
