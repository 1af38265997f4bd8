// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/map_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/core.hpp>
#include <set>

#include "adapters/formats/datasets/degrees.h"
#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/files/csv.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/missions/recordings/recording_pipeline.h"
#include "adapters/missions/recordings/recording_range.h"
#include "engine/support/quantile.h"
#include "engine/support/stopwatch.h"

namespace prospect {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// The map is made again if its floor has moved by more.
constexpr double kMovedHeight = 0.015;  // [m]
constexpr double kMovedTilt = 0.01;     // [rad]
constexpr double kLow = 0.2;            // [m]

/// A ground plane n . p + c = 0 in the recording's world, or in C without poses.
struct Floor {
  Eigen::Vector3d normal;
  double c = 0.0;
};

/// W from a world D in which the floor is known; the origin below, and x along, the camera T_DC.
Eigen::Isometry3d level(const Floor& floor, const Eigen::Isometry3d& T_DC) {
  const Eigen::Vector3d z = floor.normal;
  Eigen::Vector3d x = T_DC.linear().col(2);  // where it looks
  x -= x.dot(z) * z;
  if (x.norm() < 1e-3) x = T_DC.linear().col(0) - T_DC.linear().col(0).dot(z) * z;
  x.normalize();
  const Eigen::Vector3d eye = T_DC.translation();
  const Eigen::Vector3d below = eye - (z.dot(eye) + floor.c) * z;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear().row(0) = x.transpose();
  T.linear().row(1) = z.cross(x).transpose();
  T.linear().row(2) = z.transpose();
  T.translation() = -(T.linear() * below);
  return T;
}

GroundHypothesesOptions hypotheses_of(const MapRunOptions& options, bool poses) {
  GroundHypothesesOptions out;
  out.prior = options.prior;
  out.height = options.height;
  out.sigma_height = options.sigma_height;
  out.ground = options.mapper.ground;
  out.view_sigma_tilt = options.mapper.plane_sigma_tilt;
  out.view_sigma_height = options.mapper.plane_sigma_height;
  out.poses = poses;
  if (!poses) {
    out.tilt_tolerance = options.tilt_tolerance;
    out.height_tolerance = options.height_tolerance;
  }
  return out;
}

/// The map of a recording on one floor, frame by frame.
class FloorMap {
 public:
  FloorMap(const DepthDataset& dataset, const MapRunOptions& options, int first,
           const GroundHypothesis& ground)
      : dataset_(dataset), options_(options), floor_{ground.normal, ground.offset} {
    const Eigen::Isometry3d pose = pose_of(dataset, first);
    prior_ = options.prior;
    prior_.tilt_tolerance = options.tilt_tolerance;
    prior_.height_tolerance = options.height_tolerance;
    prior_.up = pose.linear().transpose() * floor_.normal;
    prior_.height = floor_.normal.dot(pose.translation()) + floor_.c;
    if (!dataset.has_poses()) return;
    T_WD_ = level(floor_, pose);
    PerceptionOptions perception = recording_options(T_WD_ * pose, options.loops);
    perception.depth_camera = {dataset.camera(), {Eigen::Isometry3d::Identity()}};
    for (int sensor = 1; sensor < dataset.sensors(); ++sensor) {
      perception.more_depth_cameras[sensor] = {dataset.camera(sensor), {dataset.T_FC(sensor)}};
    }
    perception.depth_mapping = options.mapper;
    perception.mapping = options.mapper.map;
    perception.movers = options.movers;
    perception_.emplace(perception);
  }

  const Floor& floor() const { return floor_; }
  const GroundPrior& prior() const { return prior_; }
  const Eigen::Isometry3d& T_WD() const { return T_WD_; }
  const BeliefMaps& maps() const { return maps_; }
  void straighten(MapRun& run) {
    if (perception_) prospect::straighten(*perception_, run);
  }

  MapRunFrame enter(int i, const DepthImage& image) {
    if (perception_) {
      const Eigen::Isometry3d T_WF = T_WD_ * dataset_.pose(i);
      const int sensor = dataset_.sensor(i);
      const Eigen::Isometry3d T_WC = T_WF * dataset_.T_FC(sensor);
      const double stamp = dataset_.stamp(i);
      MapRunFrame frame = map_at(*perception_, stamp, stamp == posed_ ? nullptr : &T_WF, drift_,
                                 [&] { return perception_->depth(stamp, image, sensor); });
      MappedFrame& mapped = frame.mapped;
      posed_ = stamp;
      frame.up = T_WC.linear() * mapped.ground.normal;
      frame.height_error = mapped.ground.height - T_WC.translation().z();
      // As the first camera would measure it.
      mapped.ground.height -= T_WC.translation().z() - T_WF.translation().z();
      ProcessorStopwatch stopwatch;
      maps_ = perception_->map().snapshot();
      frame.snapshot = stopwatch.lap();
      return frame;
    }
    MapRunFrame frame;
    MappedFrame& mapped = frame.mapped;
    mapped.stamp = dataset_.stamp(i);
    ProcessorStopwatch stopwatch;
    mapped.ground = find_ground(dataset_.camera(), image, prior_, options_.mapper.ground);
    mapped.times.ground = stopwatch.lap();
    mapped.state = mapped.ground.found ? Mapping::kOk : Mapping::kDegraded;
    if (!mapped.ground.found) mapped.reason = "no ground: " + mapped.ground.reason;
    frame.up = mapped.ground.normal;
    frame.height_error = kNan;
    return frame;
  }

  static Eigen::Isometry3d pose_of(const DepthDataset& dataset, int i) {
    return dataset.has_poses() ? dataset.pose(i) : Eigen::Isometry3d::Identity();
  }

 private:
  const DepthDataset& dataset_;
  const MapRunOptions& options_;
  Floor floor_;
  GroundPrior prior_;
  Eigen::Isometry3d T_WD_ = Eigen::Isometry3d::Identity();
  std::optional<PerceptionPipeline> perception_;
  PoseDrift drift_;
  double posed_ = kNan;  // [s] of the newest pose
  BeliefMaps maps_;
};

MapRunFrame left_out(double stamp, const std::string& reason) {
  MapRunFrame frame;
  frame.mapped.stamp = stamp;
  frame.mapped.state = Mapping::kRejected;
  frame.mapped.reason = reason;
  frame.height_error = kNan;
  return frame;
}

void record(const std::vector<GroundHypothesis>& hypotheses, int frame, double stamp, MapRun& run) {
  for (const GroundHypothesis& h : hypotheses) {
    run.ground.push_back({frame, stamp, h.number, h.height, h.pitch, h.roll, h.sigma_height,
                          h.sigma_tilt, h.frames, h.taken, h.why});
  }
}

int low_cells(const BeliefMaps& maps) {
  const VoxelGrid& voxels = *maps.voxels;
  const GridFrame& frame = maps.ground->frame();
  const int k_low = static_cast<int>(std::ceil(kLow / voxels.resolution() - 1e-9));
  int low = 0;
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    if (maps.ground->state(c) != CellState::kOccupied) continue;
    bool higher = false;
    for (int side = 0; side < 9 && !higher; ++side) {
      for (int k = k_low; k < voxels.k0() + voxels.depth() && !higher; ++k) {
        higher = voxels.state(c.i + side % 3 - 1, c.j + side / 3 - 1, k) == CellState::kOccupied;
      }
    }
    low += !higher;
  }
  return low;
}

}  // namespace

MapRun run_mapping(const DepthDataset& dataset, const MapRunOptions& options, int first,
                   int max_frames, const MapRunWatch& watch) {
  cv::setNumThreads(1);  // one core, and nothing that depends on scheduling
  MapRun run;
  run.first = options.prior;
  const int n = frames_from(first, max_frames, dataset.size());
  if (n == 0) return run;
  GroundHypotheses ground(dataset.camera(), hypotheses_of(options, dataset.has_poses()));
  std::unique_ptr<FloorMap> map;
  Elements images("images");
  std::set<int> unreadable;
  int next_look = 0;  // when to see whether the floor has moved [frames]
  const auto cancelled = [&] {
    run.cancelled = run.cancelled || (watch.cancelled && watch.cancelled());
    return run.cancelled;
  };
  // All frames before the one at `until`, anew; the map stays as it was if that is cancelled.
  const auto begin = [&](int until, const std::string& reason) {
    const GroundHypothesis& taken = *ground.taken();
    auto made = std::make_unique<FloorMap>(dataset, options, first, taken);
    std::vector<MapRunFrame> frames = run.frames;
    for (int k = first; k < until; ++k) {
      MapRunFrame& frame = frames[static_cast<std::size_t>(k - first)];
      if (unreadable.contains(k)) continue;
      if (cancelled()) return;
      const double hypotheses = frame.hypotheses;
      frame = made->enter(k, dataset.read(k));
      frame.hypotheses = hypotheses;
    }
    const int at = std::min(until, first + n - 1);
    run.changes.push_back({at - first, dataset.stamp(at), taken.number, taken.height, reason});
    map = std::move(made);
    run.frames = std::move(frames);
    next_look = 2 * (until - first + 1);
  };
  // Why the map must be made again; empty: its floor is where the estimate is.
  const auto moved = [&]() -> std::string {
    const GroundHypothesis* taken = ground.taken();
    if (!map || taken == nullptr) return "";
    const double tilt = angle_between(map->floor().normal, taken->normal);
    const double height = taken->height - map->prior().height;
    if (std::abs(height) <= kMovedHeight && tilt <= kMovedTilt) return "";
    char text[160];
    std::snprintf(
        text, sizeof text,
        "more frames moved the estimate by %.1f cm and %.1f deg; made again from the first frame",
        100.0 * height, kDegrees * tilt);
    return text;
  };
  std::string why;
  for (int i = first; i < first + n && !cancelled(); ++i) {
    DepthImage image;
    if (!images.read([&] { image = dataset.read(i); })) {
      unreadable.insert(i);
      run.frames.push_back(left_out(dataset.stamp(i), images.why()));
      if (watch.progress) watch.progress(i - first + 1, run.frames.back());
      continue;
    }
    ProcessorStopwatch stopwatch;
    // The floor is what the first camera sees.
    GroundObservation look;
    if (dataset.sensor(i) == 0) {
      look = ground.add(image, FloorMap::pose_of(dataset, i));
      if (why.empty()) why = look.reason;
    }
    record(ground.all(), i - first, dataset.stamp(i), run);
    const double hypotheses = stopwatch.lap();
    if (look.changed && ground.taken() != nullptr) {
      std::string reason = "enough frames agree";
      for (const GroundHypothesis& h : ground.all()) {
        if (run.changes.empty() || h.number != run.changes.back().hypothesis) continue;
        reason = "hypothesis " + std::to_string(h.number) + " given up: " + h.why +
                 "; made again from the first frame";
      }
      begin(i, reason);
    } else if (i - first + 1 >= next_look && map) {
      const std::string reason = moved();
      if (!reason.empty()) begin(i, reason);
      next_look = 2 * (i - first + 1);
    }
    MapRunFrame frame;
    if (ground.taken() == nullptr || !map) {
      frame = left_out(dataset.stamp(i), "no ground yet");
    } else if (look.doubtful) {
      frame = left_out(dataset.stamp(i), "a plane below the ground: not known yet what it is");
    } else {
      frame = map->enter(i, image);
    }
    frame.hypotheses = hypotheses;
    run.frames.push_back(frame);
    if (watch.progress) watch.progress(i - first + 1, frame);
  }
  if (images.bad() > 0) run.notes.push_back(images.note());
  if (!run.cancelled && ground.settle()) {
    while (!run.ground.empty() && run.ground.back().frame == n - 1) run.ground.pop_back();
    record(ground.all(), n - 1, dataset.stamp(first + n - 1), run);
    begin(first + n, "no other, though few frames show it");
  } else if (const std::string reason = moved(); !run.cancelled && !reason.empty()) {
    begin(first + n, reason);
  }
  if (run.cancelled) run.notes.push_back(cancelled_note(run.frames.size(), n));
  if (map) {
    run.first = map->prior();
    run.T_WD = map->T_WD();
    run.maps = map->maps();
    map->straighten(run);
    return run;
  }
  run.no_ground = why.empty() ? "no plane that frames agree on" : why;
  for (const GroundHypothesis& h : ground.all()) {
    char text[64];
    std::snprintf(text, sizeof text, "a plane %.2f m below the camera: ", h.height);
    run.no_ground = text + h.why;
  }
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    if (unreadable.contains(first + static_cast<int>(k))) continue;
    run.frames[k].mapped.reason = "no ground: " + run.no_ground;
  }
  return run;
}

MapSummary summarize(const MapRun& run) {
  MapSummary s;
  std::vector<double> heights, hypotheses, check, ground, scan, insert, snapshot, frame;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double squares = 0.0;
  std::map<std::string, int> reasons;
  for (const MapRunFrame& f : run.frames) {
    const MappedFrame& m = f.mapped;
    ++s.frames;
    s.ok += m.state == Mapping::kOk;
    s.degraded += m.state == Mapping::kDegraded;
    s.rejected += m.state == Mapping::kRejected;
    if (m.state == Mapping::kRejected) ++reasons[m.reason];
    check.push_back(m.times.check);
    ground.push_back(m.times.ground);
    scan.push_back(m.times.scan);
    insert.push_back(m.times.insert);
    snapshot.push_back(f.snapshot);
    hypotheses.push_back(f.hypotheses);
    frame.push_back(f.hypotheses + m.times.total() + f.snapshot);
    if (!m.ground.found) continue;
    ++s.ground;
    heights.push_back(m.ground.height);
    mean += f.up;
    squares += f.height_error * f.height_error;
  }
  int most = 0;
  for (const auto& [reason, count] : reasons) {
    if (count <= most) continue;
    most = count;
    s.rejected_reason = reason;
  }
  s.height_median = quantile(heights, 0.5);
  s.height_min = quantile(heights, 0.0);
  s.height_max = quantile(heights, 1.0);
  s.height_error = s.ground > 0 ? std::sqrt(squares / s.ground) : kNan;
  s.tilt_spread = s.tilt_worst = s.ground > 0 ? 0.0 : kNan;
  mean.normalize();
  for (const MapRunFrame& f : run.frames) {
    if (!f.mapped.ground.found) continue;
    const double off = angle_between(f.up, mean);
    s.tilt_spread += off * off / s.ground;
    s.tilt_worst = std::max(s.tilt_worst, off);
  }
  s.tilt_spread = std::sqrt(s.tilt_spread);
  s.walls = {.median = kNan, .p90 = kNan, .doubled = kNan};
  if (run.maps.ground) {
    s.free_cells = run.maps.ground->free_cells();
    s.occupied_cells = run.maps.ground->occupied_cells();
    s.low_cells = low_cells(run.maps);
    s.walls = wall_thickness(*run.maps.voxels);
  }
  for (const GroundRecord& r : run.ground) {
    if (r.frame + 1 != s.frames) continue;
    if (r.taken) {
      s.taken = r;
    } else {
      s.rejected_grounds.push_back(r);
    }
  }
  s.hypotheses = percentiles(hypotheses);
  s.check = percentiles(check);
  s.ground_plane = percentiles(ground);
  s.scan = percentiles(scan);
  s.insert = percentiles(insert);
  s.snapshot = percentiles(snapshot);
  s.frame = percentiles(frame);
  return s;
}

std::string ground_csv(const MapRun& run) {
  std::string text =
      "frame,stamp_s,state,ground,height_m,sigma_height_m,pitch_deg,roll_deg,"
      "sigma_tilt_deg,points,inliers,below,valid,obstacle_rays,floor_rays,far_rays,x_m,y_m,z_m,"
      "reason\n";
  char line[512];
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const MappedFrame& m = run.frames[i].mapped;
    const GroundPlane& g = m.ground;
    std::snprintf(line, sizeof line, "%zu,%.9f,%s,%d,", i, m.stamp,
                  std::string(to_string(m.state)).c_str(), g.found);
    text += line;
    if (g.found) {
      std::snprintf(line, sizeof line, "%.5f,%.5f,%.4f,%.4f,%.4f,", g.height, g.sigma_height(),
                    kDegrees * g.pitch(), kDegrees * g.roll(), kDegrees * g.sigma_tilt());
      text += line;
    } else {
      text += ",,,,,";
    }
    const Eigen::Vector3d t = m.T_WC.translation();
    std::snprintf(line, sizeof line, "%d,%d,%d,%.4f,%d,%d,%d,%.6f,%.6f,%.6f,", g.points, g.inliers,
                  g.below, m.valid, m.hits, m.floor, m.misses, t.x(), t.y(), t.z());
    text += line + csv::field(m.reason) + '\n';
  }
  return text;
}

}  // namespace prospect
