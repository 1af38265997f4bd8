// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/log/logged_run.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/log/map_messages.h"
#include "adapters/missions/log/step_messages.h"
#include "adapters/missions/run/configured_record.h"
#include "adapters/missions/run/summary.h"
#include "engine/support/named.h"

namespace prospect {
namespace {

/// Width and height [px] by the head of a JPEG's frame; zero where it has none.
std::pair<int, int> jpeg_size(const std::vector<std::uint8_t>& jpeg) {
  const auto two = [&](std::size_t at) { return jpeg[at] << 8 | jpeg[at + 1]; };
  for (std::size_t at = 2; at + 9 < jpeg.size() && jpeg[at] == 0xFF;) {
    const int marker = jpeg[at + 1];
    const bool frame =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (frame) return {two(at + 7), two(at + 5)};
    at += 2 + static_cast<std::size_t>(two(at + 2));
  }
  return {0, 0};
}

/// Reads the messages of a topic in the order of their times; nothing where there is none.
template <ros::Message T, class Use>
void read_topic(const BagFile& bag, const std::string& path, const char* name, const Use& use) {
  const BagTopic* topic = bag.find(name);
  if (!topic) return;
  if (topic->type != T::kType) {
    throw InputError(path + ": " + name + " is of " + topic->type + "; expected " + T::kType);
  }
  for (std::size_t i = 0; i < topic->messages.size(); ++i) {
    const std::string bytes = bag.read(topic->messages[i]);
    const std::string said = path + ": message " + std::to_string(i + 1) + " of " + name;
    use(topic->messages[i].time, ros::from_cdr<T>(bytes, said), said);
  }
}

std::string entry(const BagFile::Fields* fields, const char* name) {
  if (!fields) return "";
  const auto found = fields->find(name);
  return found == fields->end() ? "" : found->second;
}

RunRecord begun_record(const BagFile& bag, const std::string& path, const Registries& registries,
                       std::vector<std::string>& notes) {
  const std::string text = entry(bag.metadata(topic::kRun), "configuration");
  try {
    RunRecord record =
        configured_record(configuration_from_text(text, path + ": configuration", registries));
    record.configuration = text;
    return record;
  } catch (const InputError& error) {
    notes.push_back(error.lines().front() + "; robot and zones are those of the defaults");
  }
  RunRecord record = configured_record(configuration_from_text("", "defaults"));
  record.configuration = text;
  return record;
}

/// Changes of the map up to each step.
void read_map(const BagFile& bag, const std::string& path,
              std::map<std::int64_t, StepRecord*>& steps, std::vector<std::string>& notes) {
  struct Message {
    std::int64_t time = 0;
    std::size_t order = 0;  // among those of its time: the whole map first
    const BagTopic* topic = nullptr;
    std::size_t index = 0;
  };
  std::vector<Message> messages;
  for (const char* name : {topic::kMap, topic::kMapUpdates}) {
    const BagTopic* topic = bag.find(name);
    if (!topic) continue;
    for (std::size_t i = 0; i < topic->messages.size(); ++i) {
      messages.push_back(
          {topic->messages[i].time, name == std::string(topic::kMap) ? 0U : 1U, topic, i});
    }
  }
  std::stable_sort(messages.begin(), messages.end(), [](const Message& a, const Message& b) {
    return std::pair(a.time, a.order) < std::pair(b.time, b.order);
  });
  ReadMap map;
  int left_out = 0;
  std::size_t next = 0;
  for (auto& [time, step] : steps) {
    bool any = false;
    for (; next < messages.size() && messages[next].time <= time; ++next) {
      const Message& m = messages[next];
      const std::string bytes = bag.read(m.topic->messages[m.index]);
      const std::string said =
          path + ": message " + std::to_string(m.index + 1) + " of " + m.topic->name;
      const bool taken = m.order == 0
                             ? map.whole(ros::from_cdr<ros::OccupancyGrid>(bytes, said))
                             : map.part(ros::from_cdr<ros::OccupancyGridUpdate>(bytes, said));
      left_out += taken ? 0 : 1;
      any = any || taken;
    }
    if (any) step->map_changes = map.changes();
  }
  if (left_out > 0) {
    notes.push_back(path + ": " + std::to_string(left_out) +
                    " messages of the map fit no map and were left out");
  }
}

/// As many pictures of the cost-to-go as a run keeps.
void thin(std::vector<StepRecord>& steps) {
  constexpr int kMost = 150;
  for (int every = 1;; every *= 2) {
    int count = 0;
    for (StepRecord& step : steps) {
      if (step.cost_to_go && step.step % every != 0) step.cost_to_go.reset();
      count += step.cost_to_go ? 1 : 0;
    }
    if (count <= kMost) return;
  }
}

void read_pictures(const BagFile& bag, const std::string& path,
                   const std::map<std::int64_t, StepRecord*>& steps, RunRecord& record) {
  std::map<std::int64_t, LandmarkPicture> pictures;
  read_topic<ros::CompressedImage>(
      bag, path, topic::kPictures,
      [&](std::int64_t time, const ros::CompressedImage& image, const std::string&) {
        const auto step = steps.find(time);
        if (step == steps.end()) return;
        LandmarkPicture& picture = pictures[time];
        picture.frame = step->second->step;
        picture.jpeg.assign(image.data.begin(), image.data.end());
        std::tie(picture.width, picture.height) = jpeg_size(picture.jpeg);
      });
  read_topic<ros::PointCloud2>(
      bag, path, topic::kPictureFeatures,
      [&](std::int64_t time, const ros::PointCloud2& features, const std::string&) {
        const auto picture = pictures.find(time);
        if (picture != pictures.end()) picture->second.features = read_picture_features(features);
      });
  for (auto& [time, picture] : pictures) {
    if (picture.width > 0) record.pictures.push_back(std::move(picture));
  }
}

}  // namespace

LoggedRun read_logged_run(const std::string& path, const Registries& registries) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw InputError(path + ": no such file; expected the log of a mission, a .mcap file");
  }
  return read_logged_run(BagFile::open(path), path, registries);
}

LoggedRun read_logged_run(const BagFile& bag, const std::string& path,
                          const Registries& registries) {
  // A robot that was not fit to drive has made no step; the summary says why.
  const BagTopic* steps_topic = bag.find(topic::kStep);
  if ((!steps_topic || steps_topic->messages.empty()) &&
      entry(bag.metadata(topic::kSummary), "json").empty()) {
    throw InputError(path + ": no " + topic::kStep +
                     "; expected the log of a mission (prospect drive, explore --mcap)");
  }
  LoggedRun run;
  run.notes = bag.notes();
  RunRecord& record = run.record = begun_record(bag, path, registries, run.notes);

  std::vector<std::int64_t> times;
  read_topic<ros::DiagnosticArray>(
      bag, path, topic::kStep,
      [&](std::int64_t time, const ros::DiagnosticArray& values, const std::string& said) {
        // Of two steps of one instant the later counts.
        if (!times.empty() && times.back() == time) {
          times.pop_back();
          record.steps.pop_back();
        }
        StepRecord step;
        step.stamp = 1e-9 * static_cast<double>(time);
        read_step_values(values, said, step);
        times.push_back(time);
        record.steps.push_back(std::move(step));
      });
  std::map<std::int64_t, StepRecord*> steps;
  for (std::size_t i = 0; i < times.size(); ++i) steps[times[i]] = &record.steps[i];
  const auto at = [&](std::int64_t time) -> StepRecord* {
    const auto found = steps.find(time);
    return found == steps.end() ? nullptr : found->second;
  };
  read_topic<ros::Path>(bag, path, topic::kPlan,
                        [&](std::int64_t time, const ros::Path& plan, const std::string&) {
                          if (StepRecord* step = at(time)) read_horizon_path(plan, *step);
                        });
  read_topic<ros::MarkerArray>(
      bag, path, topic::kMarkers,
      [&](std::int64_t time, const ros::MarkerArray& markers, const std::string&) {
        if (StepRecord* step = at(time)) read_step_markers(markers, *step);
      });
  read_topic<ros::MarkerArray>(
      bag, path, topic::kFrontiers,
      [&](std::int64_t time, const ros::MarkerArray& markers, const std::string&) {
        if (StepRecord* step = at(time)) read_frontier_markers(markers, *step);
      });
  read_topic<ros::PointCloud2>(
      bag, path, topic::kCostToGo,
      [&](std::int64_t time, const ros::PointCloud2& points, const std::string&) {
        StepRecord* step = at(time);
        if (!step) return;
        step->cost_to_go = read_cost_to_go_points(points, kCostToGoCoarser * record.resolution);
        if (step->cost_to_go->seconds.empty()) step->cost_to_go.reset();
      });
  read_map(bag, path, steps, run.notes);
  read_pictures(bag, path, steps, record);
  thin(record.steps);

  record.summary = summarize(record.steps);
  const std::string text = entry(bag.metadata(topic::kSummary), "json");
  if (const std::optional<Summary> told = summary_from_json(text)) {
    record.summary = *told;
  } else {
    const BagFile::Fields* start = bag.metadata(topic::kRun);
    Summary& s = record.summary;
    s.world = entry(start, "world");
    s.solver = entry(start, "solver");
    const std::string seed = entry(start, "seed");
    parse_number(seed, s.seed);
    s.task = record.steps.empty() ? "" : name_of(record.steps.front().task);
    s.end = MissionEnd::kLogEndsEarly;
    s.detail = "The log ends before the mission did: the numbers are those of the steps in it.";
    run.notes.push_back(path + ": no summary; made of the " + std::to_string(record.steps.size()) +
                        " steps that are there");
  }
  if (const BagFile::Fields* dropped = bag.metadata(topic::kDropped)) {
    for (const auto& [topic, count] : *dropped) {
      run.notes.push_back(path + ": " + count + " messages of " + topic + " are not in it");
    }
  }
  return run;
}

}  // namespace prospect
