// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/log/mission_log.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/missions/run/summary.h"
#include "runtime/driver.h"
#include "runtime/health_report.h"

namespace prospect {
namespace {

McapWriter::Fields fields_of(const RunStart& s) {
  return {{"world", s.world},
          {"world_source", s.world_source},
          {"world_hash", s.world_hash},
          {"solver", s.solver},
          {"seed", std::to_string(s.seed)},
          {"real_time", s.real_time ? "1" : "0"},
          {"command_line", s.command_line},
          {"version", s.version},
          {"commit", s.commit},
          {"commit_changed", s.commit_changed ? "1" : "0"},
          {"started", s.started},
          {"configuration", s.configuration}};
}

}  // namespace

MissionLog::MissionLog(const std::string& path, const RunStart& start,
                       const MissionLogOptions& options)
    : images_(options.images),
      calls_(options.calls),
      path_(path),
      log_(path, mission_channels(options.messages.robot.depth_sensors().size()), options.file),
      messages_(options.messages,
                [this](std::size_t channel, std::int64_t time, std::string bytes) {
                  log_.put(channel, time, std::move(bytes));
                }) {
  log_.metadata(topic::kRun, fields_of(start));
  messages_.fixed();
}

void MissionLog::on_frame(const SensorFrame& frame) {
  if (const auto* scan = std::get_if<ScanFrame>(&frame)) {
    if (scan->in_B) messages_.scan(scan->stamp, *scan->in_B, scan->sensor);
  } else if (const auto* wheels = std::get_if<WheelSample>(&frame)) {
    messages_.wheels(*wheels);
  } else if (const auto* imu = std::get_if<ImuSample>(&frame)) {
    messages_.imu(*imu);
  } else if (const auto* pair = std::get_if<StereoFrame>(&frame); pair && images_) {
    if (pair->left && pair->right) messages_.pair(pair->left_stamp, *pair->left, *pair->right);
  } else if (const auto* depth = std::get_if<DepthFrame>(&frame); depth && images_) {
    if (depth->image) messages_.depth(depth->stamp, *depth->image, depth->sensor);
  }
}

void MissionLog::on_belief(const Belief& belief) { messages_.belief(belief); }

double MissionLog::asked_at(const Belief& belief) {
  return asked_ = std::max(asked_, belief.stamp);
}

void MissionLog::log_call(const Belief& belief,
                          PlannerCall (PlannerCallWriter::*call)(const Belief&)) {
  if (!calls_) return;
  const double stamp = asked_at(belief);
  if (const auto moved = writer_.map_frame(belief)) messages_.planner_call(stamp, *moved);
  messages_.planner_call(stamp, (writer_.*call)(belief));
}

void MissionLog::on_prepare(const Belief& belief) { log_call(belief, &PlannerCallWriter::prepare); }
void MissionLog::on_plan(const Belief& belief) { log_call(belief, &PlannerCallWriter::plan); }
void MissionLog::on_planned(const Plan& plan) {
  if (calls_) messages_.planner_call(asked_, writer_.planned(plan));
}
void MissionLog::on_task(const Task& task) {
  if (calls_) messages_.planner_call(asked_, writer_.task(task));
}

void MissionLog::on_record(const StepRecord& record, const MissionStep&) { messages_.step(record); }
void MissionLog::on_command(double time, const Twist& command) { messages_.command(time, command); }
void MissionLog::on_events(std::span<const Event> events) { messages_.events(events); }

void MissionLog::on_status(const DriverStatus& status, const HealthReport& health) {
  constexpr double kEvery = 1.0;  // [s]
  if (health.stamp - status_ < kEvery) return;
  status_ = health.stamp;
  messages_.status(status_, status, "log", dropped_text(log_.counts()));
}

void MissionLog::finish(const RunRecord& record) {
  if (images_) {
    std::size_t at = 0;
    for (const LandmarkPicture& picture : record.pictures) {
      while (at < record.steps.size() && record.steps[at].step < picture.frame) ++at;
      if (at == record.steps.size()) break;
      messages_.picture(record.steps[at].stamp, picture);
    }
  }
  McapWriter::Fields dropped;
  for (const McapLog::Count& count : log_.counts()) {
    if (count.dropped > 0) dropped[count.topic] = std::to_string(count.dropped);
  }
  if (!dropped.empty()) log_.metadata(topic::kDropped, dropped);
  log_.metadata(topic::kSummary, {{"json", summary_json(record.summary)}});
  log_.finish();
}

std::vector<std::string> MissionLog::notes() const {
  std::vector<std::string> notes;
  if (const std::string why = log_.error(); !why.empty()) {
    notes.push_back(path_ + ": writing failed (" + why + "); it ends early");
  }
  if (const std::string dropped = dropped_text(log_.counts()); !dropped.empty()) {
    notes.push_back(path_ + ": " + dropped);
  }
  return notes;
}

}  // namespace prospect
