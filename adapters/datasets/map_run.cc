#include "adapters/datasets/map_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/core.hpp>

#include "adapters/datasets/degrees.h"
#include "adapters/datasets/recording_range.h"
#include "adapters/files/csv.h"
#include "adapters/files/input_error.h"
#include "engine/support/quantile.h"
#include "engine/support/stopwatch.h"

namespace prospect {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Differences of ground planes that weigh the same.
constexpr double kAlikeTilt = 0.02;    // [rad]
constexpr double kAlikeHeight = 0.02;  // [m]
constexpr double kLow = 0.2;           // [m]

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// A ground plane n . p + c = 0 in the recording's world, or in C without poses.
struct Floor {
  Eigen::Vector3d normal;
  double c = 0.0;
};

/// Of the floors, the one that is nearest to all others.
Floor middle(const std::vector<Floor>& floors) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < floors.size(); ++i) {
    double sum = 0.0;
    for (const Floor& other : floors) {
      sum += angle_between(floors[i].normal, other.normal) / kAlikeTilt +
             std::abs(floors[i].c - other.c) / kAlikeHeight;
    }
    if (sum < least) {
      least = sum;
      best = i;
    }
  }
  return floors[best];
}

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
                   int max_frames, const std::function<void(int, const MapRunFrame&)>& progress) {
  cv::setNumThreads(1);  // one core, and nothing that depends on scheduling
  MapRun run;
  const int n = frames_from(first, max_frames, dataset.size());
  if (n == 0) return run;
  const PinholeCamera& camera = dataset.camera();
  const auto pose = [&](int i) {
    return dataset.has_poses() ? dataset.pose(i) : Eigen::Isometry3d::Identity();
  };

  std::vector<Floor> floors;
  std::string why;
  const auto enough = static_cast<std::size_t>(std::max(1, options.first_frames));
  for (int i = first; i < first + n && floors.size() < enough; ++i) {
    const GroundPlane ground =
        find_ground(camera, dataset.read(i), options.prior, options.mapper.ground);
    if (!ground.found) {
      if (why.empty()) why = ground.reason;
      continue;
    }
    const Eigen::Isometry3d T = pose(i);
    const Eigen::Vector3d normal = T.linear() * ground.normal;
    floors.push_back({normal, ground.height - normal.dot(T.translation())});
  }
  if (floors.empty()) {
    throw InputError("no ground in any frame: " + why +
                     "; expected a floor, or --camera-height and --camera-pitch as they are");
  }
  const Floor floor = middle(floors);
  run.first = options.prior;
  run.first.tilt_tolerance = options.tilt_tolerance;
  run.first.height_tolerance = options.height_tolerance;
  run.first.up = pose(first).linear().transpose() * floor.normal;
  run.first.height = floor.normal.dot(pose(first).translation()) + floor.c;

  std::unique_ptr<DepthMapper> mapper;
  if (dataset.has_poses()) {
    run.T_WD = level(floor, pose(first));
    mapper = std::make_unique<DepthMapper>(camera, options.mapper);
  }
  for (int i = first; i < first + n; ++i) {
    const DepthImage image = dataset.read(i);
    MapRunFrame frame;
    MappedFrame& mapped = frame.mapped;
    if (mapper) {
      const Eigen::Isometry3d T_WC = run.T_WD * pose(i);
      mapped = mapper->process(dataset.stamp(i), image, T_WC);
      frame.up = T_WC.linear() * mapped.ground.normal;
      frame.height_error = mapped.ground.height - T_WC.translation().z();
      ProcessorStopwatch watch;
      run.maps = mapper->map().snapshot();
      frame.snapshot = watch.lap();
    } else {
      mapped.stamp = dataset.stamp(i);
      ProcessorStopwatch watch;
      mapped.ground = find_ground(camera, image, run.first, options.mapper.ground);
      mapped.times.ground = watch.lap();
      mapped.state = mapped.ground.found ? Mapping::kOk : Mapping::kDegraded;
      if (!mapped.ground.found) mapped.reason = "no ground: " + mapped.ground.reason;
      frame.up = mapped.ground.normal;
      frame.height_error = kNan;
    }
    GroundRecord record;
    record.frame = i - first;
    record.stamp = mapped.stamp;
    GroundPlane plane;
    plane.normal = run.first.up;
    record.height = run.first.height;
    record.pitch = plane.pitch();
    record.roll = plane.roll();
    record.sigma_height = options.mapper.plane_sigma_height;
    record.sigma_tilt = options.mapper.plane_sigma_tilt;
    record.support = static_cast<int>(floors.size());
    record.taken = true;
    record.why = "nearest to the others of the first frames";
    run.ground.push_back(record);
    run.frames.push_back(frame);
    if (progress) progress(i - first + 1, frame);
  }
  return run;
}

MapSummary summarize(const MapRun& run) {
  MapSummary s;
  std::vector<double> heights, check, ground, scan, insert, snapshot, frame;
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
    frame.push_back(m.times.total() + f.snapshot);
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
      "frame,stamp_s,state,reason,ground,height_m,sigma_height_m,pitch_deg,roll_deg,"
      "sigma_tilt_deg,points,inliers,below,valid,obstacle_rays,floor_rays,far_rays,x_m,y_m,z_m\n";
  char line[512];
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const MappedFrame& m = run.frames[i].mapped;
    const GroundPlane& g = m.ground;
    std::snprintf(line, sizeof line, "%zu,%.9f,%s,%s,%d,", i, m.stamp,
                  std::string(to_string(m.state)).c_str(), csv::field(m.reason).c_str(), g.found);
    text += line;
    if (g.found) {
      std::snprintf(line, sizeof line, "%.5f,%.5f,%.4f,%.4f,%.4f,", g.height, g.sigma_height(),
                    kDegrees * g.pitch(), kDegrees * g.roll(), kDegrees * g.sigma_tilt());
      text += line;
    } else {
      text += ",,,,,";
    }
    const Eigen::Vector3d t = m.T_WC.translation();
    std::snprintf(line, sizeof line, "%d,%d,%d,%.4f,%d,%d,%d,%.6f,%.6f,%.6f\n", g.points, g.inliers,
                  g.below, m.valid, m.hits, m.floor, m.misses, t.x(), t.y(), t.z());
    text += line;
  }
  return text;
}

}  // namespace prospect
