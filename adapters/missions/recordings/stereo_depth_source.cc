// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/stereo_depth_source.h"

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/bag_topics.h"
#include "adapters/formats/datasets/scan_source.h"
#include "adapters/formats/datasets/stereo_dataset.h"
#include "adapters/missions/recordings/odometry_run.h"

namespace prospect {
namespace {

constexpr double kMostGap = 0.25;  // between poses [s]
// Of a depth: within so many of them a surface is.
constexpr double kDeviations = 2.0;

/// A pair and what makes depth of it; copies of the stream share it.
struct Pair {
  StereoDataset recording;
  StereoDepth depth;
};

RawImage raw_depth(const DepthImage& image) {
  RawImage raw;
  raw.width = image.width;
  raw.height = image.height;
  raw.kind = RawImage::Kind::kFloat;
  raw.bytes.resize(image.depth.size() * sizeof(float));
  std::memcpy(raw.bytes.data(), image.depth.data(), raw.bytes.size());
  return raw;
}

/// The poses of the odometry that can be mapped at.
Trajectory odometry_poses(const StereoDataset& recording) {
  Trajectory poses;
  for (const OdometryFrame& frame : run_odometry(recording).frames) {
    if (frame.restarted) break;
    if (frame.state == Localization::kOk) poses.push_back({frame.stamp, frame.T_WC});
  }
  return poses;
}

std::string accuracy_note(const StereoCamera& camera, const StereoDepth& depth) {
  char line[200];
  std::snprintf(line, sizeof line,
                "depth by stereo, f %.6g px, baseline %.4g m: %.2f to %.1f m, +- %.2g z^2 m",
                camera.left.fx, camera.baseline, depth.range().min, depth.range().max,
                depth.noise());
  return line;
}

}  // namespace

bool is_used_for_stereo_depth(const std::string& path,
                              const std::map<std::string, std::string>& topics) {
  if (find_stereo_layout(path) == nullptr) return false;
  if (!is_bag(path)) return find_depth_layout(path) == nullptr && find_scan_layout(path) == nullptr;
  if (topics.contains("left")) return !topics.contains("scan");
  if (topics.contains("depth") || is_used_for_scans(path, topics)) return false;
  const BagFile bag = BagFile::open(path);
  return find_depth_topic(bag).topic == nullptr && find_stereo_topics(bag).left != nullptr;
}

DepthSource open_stereo_depth(const std::string& path, const StereoDatasetOptions& options,
                              const StereoDepthOptions& depth) {
  StereoDataset recording = StereoDataset::open(path, options);
  const StereoCamera camera = recording.camera();
  const auto pair = std::make_shared<Pair>(Pair{std::move(recording), StereoDepth(camera, depth)});
  DepthSource source;
  source.layout = pair->recording.layout();
  source.times_assumed = pair->recording.times_assumed();
  source.notes = pair->recording.notes();
  source.notes.push_back(accuracy_note(camera, pair->depth));
  source.camera = camera.left;
  source.camera_from = path;
  source.stereo = {pair->depth.range(), pair->depth.noise()};
  const bool own = !pair->recording.ground_truth().empty();
  const Trajectory poses = own ? pair->recording.ground_truth() : odometry_poses(pair->recording);
  std::vector<int> kept;
  for (int i = 0; i < pair->recording.size(); ++i) {
    const double stamp = pair->recording.stamp(i);
    const auto T = pose_at(poses, stamp, own ? kMostGap : 0.0);
    if (!T) continue;
    kept.push_back(i);
    source.poses.push_back(*T);
    source.images.stamps.push_back(stamp);
    source.images.names.push_back(path + " frame " + std::to_string(i));
  }
  const int size = pair->recording.size();
  const int with = static_cast<int>(kept.size());
  source.without_pose = size - with;
  const std::string from = own ? "the recording" : "the visual odometry";
  if (with == 0) {
    throw InputError(path + ": none of " + std::to_string(size) + " frames has a pose by " + from +
                     "; expected poses to map at");
  }
  source.notes.push_back("poses by " + from + ", of " + std::to_string(with) + " of " +
                         std::to_string(size) + " frames");
  source.images.name = path;
  source.images.read = [pair, kept = std::move(kept)](std::size_t i) {
    const StereoDataset::Pair images = pair->recording.read(kept.at(i));
    return raw_depth(pair->depth.depth(images.left.view(), images.right.view()));
  };
  return source;
}

double sharp_range(const StereoDepthAccuracy& stereo, double resolution) {
  return std::sqrt(resolution / (kDeviations * stereo.noise));
}

void set_stereo_accuracy(const StereoDepthAccuracy& stereo, double range,
                         DepthMapperOptions& mapper) {
  mapper.map.max_range = range;
  mapper.map.offset_quadratic = kDeviations * stereo.noise;
  mapper.range = stereo.range;
  mapper.mismatches = true;
  mapper.ground.range = stereo.range;
  mapper.ground.noise_quadratic = stereo.noise;
}

}  // namespace prospect
