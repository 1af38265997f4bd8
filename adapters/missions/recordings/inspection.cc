// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/inspection.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/depth_dataset.h"
#include "adapters/formats/datasets/frame_pairs.h"
#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/scan_source.h"
#include "adapters/formats/datasets/stereo_dataset.h"
#include "adapters/formats/files/extension.h"
#include "adapters/missions/recordings/odometry_run.h"
#include "adapters/missions/recordings/scan_run.h"
#include "adapters/missions/recordings/stereo_depth_source.h"

namespace prospect {
namespace {

using Json = nlohmann::ordered_json;

// The odometry looks for the time offset of the cameras over so much of a recording,
constexpr double kOffsetTime = 5.0;  // [s]
constexpr int kOffsetFrames = 60;
// and has found it where its deviation has become so much less than before the first image.
constexpr double kOffsetLearned = 0.05;

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

/// Times of a camera's images, and what the first one is.
Json stream_json(const ImageStream& stream, std::vector<std::string>& missing) {
  const double step = median_step(stream.stamps);
  int gaps = 0;
  double longest = 0.0;
  for (std::size_t i = 1; i < stream.size(); ++i) {
    const double passed = stream.stamps[i] - stream.stamps[i - 1];
    gaps += passed > 1.8 * step;
    longest = std::max(longest, passed);
  }
  Json json = {{"from", stream.name},
               {"images", stream.size()},
               {"rate_hz", finite_or_null(1.0 / step)},
               {"first_s", stream.size() > 0 ? Json(stream.stamps.front()) : Json()},
               {"last_s", stream.size() > 0 ? Json(stream.stamps.back()) : Json()},
               {"gaps", gaps},
               {"longest_step_s", stream.size() > 1 ? Json(longest) : Json()}};
  if (stream.size() == 0) return json;
  try {
    const RawImage first = first_readable(stream);
    json["width"] = first.width;
    json["height"] = first.height;
    json["channels"] = first.channels;
    json["bits"] = first.kind == RawImage::Kind::k8    ? 8
                   : first.kind == RawImage::Kind::k16 ? 16
                                                       : 32;
    json["significant_bits"] = first.kind == RawImage::Kind::kFloat ? 32 : significant_bits(first);
  } catch (const InputError& error) {
    missing.push_back(error.lines()[0]);
  }
  return json;
}

Json calibration_json_of(const StereoCalibration& c) {
  if (c.rectified) {
    return {{"from", c.from},
            {"rectified", true},
            {"lens", "none"},
            {"focal_px", c.camera.left.fx},
            {"principal_point_px", {c.camera.left.cx, c.camera.left.cy}},
            {"baseline_m", c.camera.baseline}};
  }
  return {{"from", c.from},
          {"rectified", false},
          {"lens", lens_name(c.left)},
          {"focal_px", c.left.pinhole.fx},
          {"principal_point_px", {c.left.pinhole.cx, c.left.pinhole.cy}},
          {"baseline_m", (c.right.T_BC.translation() - c.left.T_BC.translation()).norm()}};
}

void add_missing(std::vector<std::string>& missing, const std::string& line) {
  if (std::find(missing.begin(), missing.end(), line) == missing.end()) missing.push_back(line);
}

/// What was noticed, what is missing, and the lines that would supply it.
void add_remarks(Json& json, const std::vector<std::string>& notes,
                 const std::vector<std::string>& missing,
                 const std::vector<std::string>& supply = {}) {
  json["notes"] = notes;
  json["missing"] = missing;
  json["supply"] = supply;
}

/// Null: there is none, or it is left out, as a note says.
Json imu_json(const ImuRecording& imu) {
  if (imu.samples.empty()) return {};
  std::vector<double> stamps;
  for (const ImuSample& sample : imu.samples) stamps.push_back(sample.stamp);
  return {{"from", imu.from},
          {"samples", stamps.size()},
          {"rate_hz", finite_or_null(1.0 / median_step(stamps))},
          {"first_s", stamps.front()},
          {"last_s", stamps.back()}};
}

/// By how much later the right image is taken than the left one, as the odometry finds it over the
/// first seconds; nulls where it does not.
void add_time_offset(Json& json, const StereoDataset& dataset) {
  int frames = 0;
  while (frames < std::min(dataset.size(), kOffsetFrames) &&
         dataset.stamp(frames) <= dataset.stamp(0) + kOffsetTime) {
    ++frames;
  }
  const OdometrySummary s = summarize(run_odometry(dataset, {}, 0, frames));
  const double prior = CameraTimeOffsetOptions().prior_sigma;
  const bool known = s.camera_time_offset_sigma < kOffsetLearned * prior;
  json["time_offset_s"] = known ? finite_or_null(s.camera_time_offset) : Json();
  json["time_offset_sigma_s"] = known ? finite_or_null(s.camera_time_offset_sigma) : Json();
  json["time_offset_frames"] = frames;
  json["out_of_step"] = s.out_of_step.empty() ? Json() : Json(s.out_of_step);
}

Json inspect_stereo(const std::string& path, const StereoDatasetOptions& options) {
  StereoSource source = open_stereo_source(path, options);
  std::vector<std::string> missing = source.missing, notes = source.notes;
  std::vector<std::string> supply;
  Json json = {
      {"kind", "stereo pair"}, {"used_by", "prospect odometry"}, {"layout", source.layout}};
  json["left"] = stream_json(source.left, missing);
  json["right"] = stream_json(source.right, missing);
  const FramePairs pairs = pair_frames(source.left, source.right, options.sync);
  json["pairs"] = pairs.pairs.size();
  json["unpaired"] = pairs.left_alone + pairs.right_alone;
  const bool paired = !pairs.pairs.empty();
  json["right_after_left_s"] = paired ? Json(pairs.offset) : Json();
  json["right_after_left_most_s"] = paired ? Json(pairs.largest_offset) : Json();
  json["sync_s"] = pairs.tolerance;
  json["calibration"] = source.calibration ? calibration_json_of(*source.calibration) : Json();
  json["imu"] = imu_json(source.imu);
  json["ground_truth_poses"] = source.truth.empty() ? Json() : Json(source.truth.size());
  if (!source.calibration) {
    supply = {"calib.txt beside the images of a rectified pair (f, cx, cy in px, baseline B in m):",
              "  P0: f 0 cx 0 0 f cy 0 0 0 1 0", "  P1: f 0 cx -f*B 0 f cy 0 0 0 1 0",
              "or --calibration FILE: ROS camera_info (left.yaml,right.yaml), OpenCV stereo YAML, "
              "Kalibr camchain"};
  }
  if (source.left.size() > 0 && source.right.size() > 0) {
    const std::string problem = pairing_problem(pairs, source.left, source.right);
    if (!problem.empty()) add_missing(missing, problem);
  }
  if (missing.empty()) {
    // What only the images themselves tell.
    try {
      const StereoDataset dataset = StereoDataset::open(std::move(source), options);
      notes = dataset.notes();
      add_time_offset(json, dataset);
    } catch (const InputError& error) {
      add_missing(missing, error.lines()[0]);
    }
  }
  add_remarks(json, notes, missing, supply);
  return json;
}

Json inspect_depth(const std::string& path, const DepthDatasetOptions& options) {
  const DepthSource source = open_depth_source(path, options);
  std::vector<std::string> missing = source.missing, notes = source.notes, supply;
  Json json = {{"kind", "depth images"}, {"used_by", "prospect map"}, {"layout", source.layout}};
  json["depth"] = stream_json(source.images, missing);
  json["poses"] = source.poses.empty() ? Json() : Json(source.poses.size());
  json["without_pose"] = source.without_pose;
  json["intrinsics"] = source.camera
                           ? Json({{"from", source.camera_from},
                                   {"focal_px", source.camera->fx},
                                   {"principal_point_px", {source.camera->cx, source.camera->cy}}})
                           : Json();
  json["depth_scale"] = Json();
  if (!source.camera) {
    supply = {"camera-intrinsics.txt beside the images (px):", "  fx 0 cx", "  0 fy cy", "  0 0 1",
              "or --camera FX FY CX CY"};
  }
  if (missing.empty()) {
    try {
      const DepthDataset dataset = DepthDataset::open(path, options);
      notes = dataset.notes();
      json["depth_scale"] = dataset.depth_scale();
      if (dataset.depth_scale_doubtful()) missing.push_back(path + ": " + notes.back());
    } catch (const InputError& error) {
      add_missing(missing, error.lines()[0]);
    }
  }
  if (source.poses.empty()) {
    notes.push_back("no poses: the ground is measured, nothing is mapped");
  }
  add_remarks(json, notes, missing, supply);
  return json;
}

Json inspect_scans(const std::string& path, const ScanOptions& options) {
  const ScanSource source = open_scan_source(path, options);
  std::vector<std::string> missing = source.missing, notes = source.notes;
  const bool any = !source.stamps.empty();
  Json json = {{"kind", source.planar ? "scans of one plane" : "clouds of points"},
               {"used_by", "prospect map"},
               {"layout", source.layout},
               {"scans", source.scans},
               {"from", source.from},
               {"rate_hz", finite_or_null(1.0 / median_step(source.stamps))},
               {"first_s", any ? Json(source.stamps.front()) : Json()},
               {"last_s", any ? Json(source.stamps.back()) : Json()},
               {"points", source.points},
               {"range_m", source.max_range > 0.0 ? Json(source.max_range) : Json()},
               {"poses", any ? Json(source.stamps.size()) : Json()},
               {"poses_by", source.fixed.empty() ? Json() : Json(source.fixed)},
               {"without_pose", source.without_pose}};
  if (missing.empty()) {
    try {
      const ScanPlacement placement = place_scans(source, 0.0);
      notes.insert(notes.end(), placement.notes.begin(), placement.notes.end());
    } catch (const InputError& error) {
      add_missing(missing, error.lines()[0]);
    }
  }
  add_remarks(json, notes, missing);
  return json;
}

/// A stereo pair is mapped where there is nothing else, or it is chosen.
void say_whether_pairs_are_mapped(Json& recordings, const std::string& path,
                                  const std::map<std::string, std::string>& topics) {
  const auto is_pair = [](const Json& r) { return r.contains("left"); };
  const auto pair = std::find_if(recordings.begin(), recordings.end(), is_pair);
  if (pair == recordings.end()) return;
  if (is_bag(path) && !(*pair)["missing"].empty()) return;  // it may not be readable at all
  if (!is_used_for_stereo_depth(path, topics)) return;
  for (Json& r : recordings) r["used_by"] = nullptr;
  (*pair)["used_by"] = "prospect odometry, prospect map";
}

/// Of a bag with depth images and scans `prospect map` uses one kind.
void say_which_is_mapped(Json& recordings, bool scans) {
  Json *depth_images = nullptr, *lidar = nullptr;
  for (Json& r : recordings) {
    if (r.contains("depth")) depth_images = &r;
    if (r.contains("scans")) lidar = &r;
  }
  if (depth_images == nullptr || lidar == nullptr) return;
  (scans ? *depth_images : *lidar)["used_by"] = nullptr;
  (scans ? *depth_images : *lidar)["notes"].push_back(
      scans ? "`prospect map` uses the scans, as --topics scan=TOPIC says; without it these"
            : "`prospect map` uses the depth images; with --topics scan=TOPIC these");
}

struct OtherKind {
  const char* ending;
  const char* what;
  const char* used_by;
};
constexpr OtherKind kOtherKinds[] = {
    {".bt", "OctoMap", "prospect explore"},
    {".ot", "OctoMap", "prospect explore"},
    {".pgm", "image of a floor plan", "prospect explore"},
    {".png", "image of a floor plan", "prospect explore"},
    {".bmp", "image of a floor plan", "prospect explore"},
    {".map", "MovingAI grid", "prospect explore"},
    {".obj", "mesh", "prospect explore"},
    {".dae", "mesh", "prospect explore"},
    {".gltf", "mesh", "prospect explore"},
    {".glb", "mesh", "prospect explore"},
    {".stl", "mesh", "prospect explore"},
    {".ply", "mesh or cloud of points", "prospect explore"},
    {".pcd", "cloud of points", "prospect explore"},
    {".world", "Gazebo world", "prospect explore"},
    {".sdf", "Gazebo world", "prospect explore"},
    {".h5", "planning problem", "prospect solve"},
    {".yaml", "world file, ROS map or configuration", "prospect explore"},
    {".yml", "world file, ROS map or configuration", "prospect explore"}};

Json name_other(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::is_directory(path, error)) {
    if (fs::exists(path + "/steps.csv", error) && fs::exists(path + "/config.yaml", error)) {
      return {{"what", "run folder"}, {"used_by", "prospect report"}};
    }
    return {};
  }
  const std::string ending = lower_case_extension(path);
  for (const OtherKind& kind : kOtherKinds) {
    if (ending == kind.ending) return {{"what", kind.what}, {"used_by", kind.used_by}};
  }
  return {};
}

std::string formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string stream_line(const char* name, const Json& s) {
  std::string line = std::string(name) + s["images"].dump() + " images";
  if (s.contains("width")) {
    line += " of " + s["width"].dump() + " x " + s["height"].dump() + " px, " +
            (s["channels"] == 1 ? "grey" : "colour") + ", " + s["bits"].dump() + " bits";
    if (s["significant_bits"] != s["bits"]) {
      line += " (" + s["significant_bits"].dump() + " used)";
    }
  }
  if (s["rate_hz"].is_number()) line += ", " + formatted("%.4g Hz", s["rate_hz"].get<double>());
  if (s["gaps"].get<int>() > 0) {
    line += ", " + s["gaps"].dump() + " gaps, the longest " +
            formatted("%.3g s", s["longest_step_s"].get<double>());
  }
  return line + ": " + s["from"].get<std::string>() + "\n";
}

std::string recording_text(const Json& r) {
  std::string text = r["layout"].get<std::string>() + ", " + r["kind"].get<std::string>();
  if (r["used_by"].is_string()) {
    std::string commands = r["used_by"].get<std::string>();
    if (const auto comma = commands.find(", "); comma != std::string::npos) {
      commands.replace(comma, 2, "` and `");
    }
    text += ", for `" + commands + "`";
  }
  text += "\n";
  if (r.contains("left")) {
    text += stream_line("left         ", r["left"]) + stream_line("right        ", r["right"]);
    text += "pairs        " + r["pairs"].dump() + ", " + r["unpaired"].dump() + " images alone";
    if (r["right_after_left_s"].is_number()) {
      text += "; right less left " +
              formatted("%.3g ms in the median, ", 1e3 * r["right_after_left_s"].get<double>()) +
              formatted("%.3g ms at most", 1e3 * r["right_after_left_most_s"].get<double>());
    }
    text += "\n";
    if (r.contains("time_offset_s")) {
      const std::string over =
          " by the odometry over " + r["time_offset_frames"].dump() + " frames";
      text += "time offset  ";
      if (r["time_offset_s"].is_number()) {
        text += formatted("right image taken %.2g ms after the left, ",
                          1e3 * r["time_offset_s"].get<double>()) +
                formatted("known to %.2g ms,", 1e3 * r["time_offset_sigma_s"].get<double>()) +
                over + "\n";
      } else {
        text += "not found" + over + ": it shows where the cameras turn\n";
      }
      if (r["out_of_step"].is_string()) {
        text += "note         " + r["out_of_step"].get<std::string>() + "\n";
      }
    }
    const Json& c = r["calibration"];
    if (c.is_null()) {
      text += "calibration  none\n";
    } else {
      text += "calibration  " + formatted("f %.6g px, ", c["focal_px"].get<double>()) +
              formatted("baseline %.4g m, ", c["baseline_m"].get<double>()) +
              (c["rectified"].get<bool>() ? "rectified images"
                                          : "lens " + c["lens"].get<std::string>()) +
              ": " + c["from"].get<std::string>() + "\n";
    }
    text +=
        "truth        " +
        (r["ground_truth_poses"].is_null() ? "none" : r["ground_truth_poses"].dump() + " poses") +
        "\n";
    if (const Json& imu = r["imu"]; !imu.is_null()) {
      text += "imu          " + imu["samples"].dump() + " samples";
      if (imu["rate_hz"].is_number()) {
        text += ", " + formatted("%.4g Hz", imu["rate_hz"].get<double>());
      }
      text += ": " + imu["from"].get<std::string>() + "\n";
    }
  } else if (r.contains("scans")) {
    text +=
        "scans        " + r["scans"].dump() + ", the first of " + r["points"].dump() + " points";
    if (r["rate_hz"].is_number()) text += ", " + formatted("%.4g Hz", r["rate_hz"].get<double>());
    if (r["range_m"].is_number()) {
      text += ", to " + formatted("%.4g m", r["range_m"].get<double>());
    }
    text += ": " + r["from"].get<std::string>() + "\n";
    text += "poses        " +
            (r["poses"].is_null()
                 ? "none"
                 : r["poses"].dump() + " scans have one, by " + r["poses_by"].get<std::string>()) +
            "\n";
  } else {
    text += stream_line("depth        ", r["depth"]);
    text += "poses        " +
            (r["poses"].is_null() ? "none" : r["poses"].dump() + " frames have one") + "\n";
    const Json& c = r["intrinsics"];
    text += "intrinsics   " +
            (c.is_null() ? "none"
                         : formatted("f %.6g px: ", c["focal_px"].get<double>()) +
                               c["from"].get<std::string>()) +
            "\n";
  }
  for (const Json& note : r["notes"]) text += "note         " + note.get<std::string>() + "\n";
  for (const Json& line : r["missing"]) text += "missing      " + line.get<std::string>() + "\n";
  for (const Json& line : r["supply"]) text += "  supply     " + line.get<std::string>() + "\n";
  return text;
}

/// Of a mission's log what it says of itself; null: it is none.
Json mission_json(const BagFile& bag) {
  const BagTopic* steps = bag.find(topic::kStep);
  const BagFile::Fields* run = bag.metadata(topic::kRun);
  if (!steps || steps->messages.empty() || !run) return nullptr;
  Json json;
  for (const char* name : {"world", "seed", "started", "version", "commit", "command_line"}) {
    const auto found = run->find(name);
    json[name] = found == run->end() ? "" : found->second;
  }
  json["steps"] = steps->messages.size();
  json["whole"] = bag.notes().empty() && bag.metadata(topic::kSummary) != nullptr;
  return json;
}

}  // namespace

Json inspect_path(const std::string& path, const StereoDatasetOptions& stereo,
                  const DepthDatasetOptions& depth, Found& found) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw InputError(path + ": nothing is there; expected a recording, map or world");
  }
  Json json = {{"path", path}, {"found", ""}, {"recordings", Json::array()}};
  Json recordings = Json::array();
  if (find_stereo_layout(path) != nullptr) recordings.push_back(inspect_stereo(path, stereo));
  if (find_depth_layout(path) != nullptr) recordings.push_back(inspect_depth(path, depth));
  if (is_bag(path)) {
    Json topics = Json::array();
    try {
      const BagFile bag = BagFile::open(path);
      for (const BagTopic& topic : bag.topics()) {
        topics.push_back({{"name", topic.name},
                          {"type", topic.type},
                          {"encoding", topic.encoding},
                          {"messages", topic.messages.size()}});
      }
      json["mission"] = mission_json(bag);
    } catch (const InputError&) {
      // Each recording says so.
    }
    json["topics"] = topics;
  }
  if (find_scan_layout(path) != nullptr) {
    recordings.push_back(inspect_scans(path, {depth.topics, depth.fixed_frame}));
  }
  // A bag may be of several kinds: what it holds nothing for, it is not.
  const auto is_empty = [](const Json& r) {
    return r.contains("left")    ? r["left"]["images"] == 0
           : r.contains("depth") ? r["depth"]["images"] == 0
                                 : r["scans"] == 0;
  };
  if (!std::all_of(recordings.begin(), recordings.end(), is_empty)) {
    Json kept = Json::array();
    for (const Json& r : recordings) {
      if (!is_empty(r)) kept.push_back(r);
    }
    recordings = kept;
  }
  say_whether_pairs_are_mapped(recordings, path, stereo.topics);
  say_which_is_mapped(recordings, is_used_for_scans(path, depth.topics));
  json["recordings"] = recordings;
  found = Found::kUnknown;
  for (const Json& recording : recordings) {
    if (recording["missing"].empty()) found = Found::kUsable;
  }
  if (json.contains("mission") && !json["mission"].is_null()) found = Found::kUsable;
  if (!recordings.empty() && found == Found::kUnknown) found = Found::kIncomplete;
  if (recordings.empty()) {
    const Json other = name_other(path);
    if (!other.is_null()) {
      json.update(other);
      found = Found::kUsable;
    } else {
      Json looked_for = Json::array();
      for (const StereoLayout& layout : stereo_layouts()) looked_for.push_back(layout.looked_for);
      for (const DepthLayout& layout : depth_layouts()) looked_for.push_back(layout.looked_for);
      for (const ScanLayout& layout : scan_layouts()) looked_for.push_back(layout.looked_for);
      looked_for.push_back(
          "a map, mesh, cloud, world or problem: .bt .ot .pgm .png .bmp .yaml .obj .dae .gltf .glb "
          ".stl .ply .pcd .world .sdf .h5");
      json["looked_for"] = looked_for;
    }
  }
  json["found"] = found == Found::kUsable       ? "usable"
                  : found == Found::kIncomplete ? "incomplete"
                                                : "unknown";
  return json;
}

std::string inspection_text(const Json& inspection) {
  std::string text;
  for (const Json& topic : inspection.value("topics", Json::array())) {
    text += "topic        " + topic["name"].get<std::string>() + ", " + topic["messages"].dump() +
            " of " + topic["type"].get<std::string>() +
            (topic["encoding"] == "cdr" ? "" : " in " + topic["encoding"].get<std::string>()) +
            "\n";
  }
  for (const Json& recording : inspection["recordings"]) text += recording_text(recording);
  if (inspection.contains("mission") && !inspection["mission"].is_null()) {
    const Json& m = inspection["mission"];
    text += "log of a mission, for `prospect report`\n";
    text += "mission      " + m["world"].get<std::string>() + ", seed " +
            m["seed"].get<std::string>() + ", " + m["steps"].dump() + " steps, " +
            (m["whole"].get<bool>() ? "whole" : "ends early") + "\n";
    text += "begun        " + m["started"].get<std::string>() + " by version " +
            m["version"].get<std::string>() + ": " + m["command_line"].get<std::string>() + "\n";
  }
  if (inspection.contains("what")) {
    text += inspection["what"].get<std::string>() + ", for `" +
            inspection["used_by"].get<std::string>() + "`\n";
  }
  if (inspection.contains("looked_for")) {
    text += "nothing known; looked for\n";
    for (const Json& line : inspection["looked_for"]) {
      text += "  " + line.get<std::string>() + "\n";
    }
  }
  return text;
}

}  // namespace prospect
