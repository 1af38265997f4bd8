#include "adapters/missions/log/mission_log.h"

#include <utility>

#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/missions/run/summary.h"

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
      path_(path),
      log_(path, mission_channels(), options.file),
      messages_(options.messages,
                [this](std::size_t channel, std::int64_t time, std::string bytes) {
                  log_.put(channel, time, std::move(bytes));
                }) {
  log_.metadata(topic::kRun, fields_of(start));
  messages_.fixed();
}

void MissionLog::belief(const Belief& belief) { messages_.belief(belief); }
void MissionLog::command(double time, const Twist& command) { messages_.command(time, command); }
void MissionLog::step(const StepRecord& step) { messages_.step(step); }
void MissionLog::planner_call(double time, const PlannerCall& call) {
  messages_.planner_call(time, call);
}
void MissionLog::events(const std::vector<Event>& events) { messages_.events(events); }
void MissionLog::status(double time, const DriverStatus& status) {
  messages_.status(time, status, "log", dropped_text(log_.counts()));
}
void MissionLog::scan(double time, const DepthScan& in_B) { messages_.scan(time, in_B); }
void MissionLog::wheels(const WheelSample& wheels) { messages_.wheels(wheels); }
void MissionLog::pair(double time, const ImagePair& pair) {
  if (images_) messages_.pair(time, pair);
}
void MissionLog::depth(double time, const DepthImage& image) {
  if (images_) messages_.depth(time, image);
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
