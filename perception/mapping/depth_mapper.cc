// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/depth_mapper.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "engine/support/stopwatch.h"
#include "models/knobs.h"
#include "models/parameter_check.h"
#include "models/reason.h"
#include "perception/mapping/moving_surface.h"
#include "perception/odometry/rotation_between.h"

namespace prospect {
namespace {

constexpr int kCheckStride = 4;      // of the pixels that the image is judged by
constexpr double kFarBelow = 0.2;    // [m]: no noise of a floor
constexpr double kJustBelow = 1e-6;  // [m]
constexpr double kSure = 5.0;        // [standard deviations] that none of the rays is off by

double gain(double prior, double measured, double least) {
  const double p = prior * prior;
  return p > 0.0 ? p / (p + measured * measured + least * least) : 0.0;
}

}  // namespace

std::string_view to_string(Mapping state) {
  switch (state) {
    case Mapping::kOk:
      return "ok";
    case Mapping::kDegraded:
      return "degraded";
    default:
      return "rejected";
  }
}

DepthMapper::DepthMapper(const PinholeCamera& camera, const DepthMapperOptions& options,
                         std::shared_ptr<OccupancyMapper> map, std::shared_ptr<MoverTracker> movers)
    : camera_(camera),
      options_(options),
      map_(map ? std::move(map) : std::make_shared<OccupancyMapper>(options.map)),
      movers_(std::move(movers)),
      below_(2.0 * options.map.resolution),
      poses_({options.max_speed, options.max_turn_rate, kFarthestVoxel * options.map.resolution}) {
  validate(camera);
  check_parameter(options.range.min > 0.0 && options.range.max > options.range.min &&
                      std::isfinite(options.range.max),
                  "depth mapper", "range", options.range.max,
                  "above its lower end, which is above 0 m");
  check_knobs("depth mapper", options);
  const double spacing = options.ray_spacing * options.map.resolution *
                         std::min(camera.fx, camera.fy) / options.map.max_range;
  stride_ = static_cast<int>(std::clamp(std::floor(spacing), 1.0, 64.0));
}

/// Whether the image is worth entering.
bool DepthMapper::check_image(const DepthImage& image, const std::optional<Eigen::Isometry3d>& pose,
                              MappedFrame& out) {
  if (!image.whole() || image.width != camera_.width || image.height != camera_.height) {
    add_reason(out.reason, "the image has the wrong size");
    return false;
  }
  const bool same = last_image_.whole() && last_image_.same(image);
  if (!same) last_image_ = image;
  const bool frozen = repeated_.hangs(same, pose);
  int pixels = 0, valid = 0, neighbours = 0, rough = 0;
  int half[4] = {0, 0, 0, 0};  // valid ones: left, right, upper, lower
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0.0F;
  for (int v = kCheckStride / 2; v < image.height; v += kCheckStride) {
    for (int u = kCheckStride / 2; u < image.width; u += kCheckStride) {
      ++pixels;
      const float z = image.at(u, v);
      if (!options_.range.holds(z)) continue;
      ++valid;
      ++half[2 * u < image.width ? 0 : 1];
      ++half[2 * v < image.height ? 2 : 3];
      nearest = std::min(nearest, z);
      farthest = std::max(farthest, z);
      const float next = u + 1 < image.width ? image.at(u + 1, v) : DepthImage::kInvalid;
      if (!options_.range.holds(next)) continue;
      ++neighbours;
      rough += std::abs(next - z) > 0.1F * z;
    }
  }
  out.valid = static_cast<double>(valid) / std::max(1, pixels);
  if (valid == 0) {
    add_reason(out.reason, "the image has no depth");
    return false;
  }
  if (frozen) {
    add_reason(out.reason, "the image is frozen");
    return false;
  }
  if (out.valid < options_.least_valid) {
    add_reason(out.reason, "the image has hardly any depth");
    return false;
  }
  if (nearest == farthest) {
    add_reason(out.reason, "the depth is everywhere the same");
    return false;
  }
  if (rough > options_.most_rough * std::max(1, neighbours)) {
    add_reason(out.reason, "the depth is noise");
    return false;
  }
  if (out.valid < options_.little_valid) {
    add_reason(out.reason, "the image has little depth");
    out.state = Mapping::kDegraded;
  } else {
    constexpr const char* kNames[4] = {"left", "right", "upper", "lower"};
    for (int i = 0; i < 4; ++i) {
      if (half[i] > 0.5 * options_.least_valid * pixels) continue;
      add_reason(out.reason, std::string("no depth in the ") + kNames[i] + " half");
      out.state = Mapping::kDegraded;
    }
  }
  return true;
}

void DepthMapper::correct(MappedFrame& frame) const {
  if (!frame.ground.found) return;
  const double k_tilt =
      gain(options_.pose_sigma_tilt, frame.ground.sigma_tilt(), options_.plane_sigma_tilt);
  const double k_height =
      gain(options_.pose_sigma_height, frame.ground.sigma_height(), options_.plane_sigma_height);
  const Eigen::Vector3d up = frame.T_WC.linear() * frame.ground.normal;
  const Eigen::AngleAxisd whole(rotation_between(up, Eigen::Vector3d::UnitZ()));
  frame.T_WC.linear() =
      Eigen::AngleAxisd(k_tilt * whole.angle(), whole.axis()) * frame.T_WC.linear();
  double& z = frame.T_WC.translation().z();
  z += k_height * (frame.ground.height - z);
}

double DepthMapper::floor_margin(const MappedFrame& frame, double z) const {
  const double height = std::max(0.0, frame.T_WC.translation().z());
  return std::clamp(options_.ground.gate * ground_sigma(height, z, options_.ground),
                    options_.floor_margin, options_.most_margin);
}

std::vector<char> DepthMapper::find_moving(const DepthImage& image, const MappedFrame& frame,
                                           const MotionInView& motion) const {
  PointLattice lattice;
  lattice.stride = stride_;
  for (int v = stride_ / 2; v < image.height; v += stride_, ++lattice.rows) {
    lattice.columns = 0;
    for (int u = stride_ / 2; u < image.width; u += stride_, ++lattice.columns) {
      const double z = image.at(u, v);
      const bool valid = options_.range.holds(z);
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      if (valid) p = z * pixel_ray(camera_, u, v);
      const double above = frame.ground.found ? frame.ground.above(p) : (frame.T_WC * p).z();
      lattice.points.push_back(p);
      lattice.solid.push_back(valid && above > floor_margin(frame, z));
    }
  }
  return moving_surface(camera_, image, lattice, frame.T_WC.inverse() * motion, options_.edge);
}

/// False if too much lies below the floor.
bool DepthMapper::make_scan(const DepthImage& image, const std::vector<char>& moving,
                            MappedFrame& frame, DepthScan& scan) {
  const DepthRange& range = options_.range;
  const Eigen::Matrix3d R = frame.T_WC.linear();
  const Eigen::Vector3d t = frame.T_WC.translation();
  const double reach = options_.map.max_range;
  scan.origin = t;
  scan.reach = reach;
  int points = 0, far_below = 0;
  // Between a nearer and a farther neighbour; one without a depth may be either, so that losing
  // pixels never adds knowledge.
  const auto between = [&](double a, double z, double b) {
    const double jump = options_.edge * z;
    const bool may_be_nearer_a = !range.holds(a) || a < z - jump;
    const bool may_be_nearer_b = !range.holds(b) || b < z - jump;
    const bool may_be_farther_a = !range.holds(a) || a > z + jump;
    const bool may_be_farther_b = !range.holds(b) || b > z + jump;
    return (may_be_nearer_a && may_be_farther_b) || (may_be_farther_a && may_be_nearer_b);
  };
  std::size_t pixel = 0;
  for (int v = stride_ / 2; v < image.height; v += stride_) {
    for (int u = stride_ / 2; u < image.width; u += stride_, ++pixel) {
      const double z = image.at(u, v);
      if (!range.holds(z)) continue;
      if (!moving.empty() && moving[pixel]) {
        scan.passing.push_back(R * (z * pixel_ray(camera_, u, v)) + t);
        ++frame.moving;
        continue;
      }
      if (u > 0 && u + 1 < image.width && between(image.at(u - 1, v), z, image.at(u + 1, v))) {
        continue;
      }
      if (v > 0 && v + 1 < image.height && between(image.at(u, v - 1), z, image.at(u, v + 1))) {
        continue;
      }
      const Eigen::Vector3d p = z * pixel_ray(camera_, u, v);
      const Eigen::Vector3d p_W = R * p + t;
      ++points;
      far_below += p_W.z() < -kFarBelow;
      const double above = frame.ground.found ? frame.ground.above(p) : p_W.z();
      const double margin = floor_margin(frame, z);
      if (above < -margin) {
        // By the measured plane and by the pose: then the ray went on through the floor's plane.
        const double sigma = ground_sigma(std::max(0.0, t.z()), z, options_.ground);
        const double through = -std::max({margin, map_->options().slice.step, kSure * sigma});
        const double along = depth_sigma(z, options_.ground) * p.norm() / z;
        if (above < through && p_W.z() < through &&
            (!options_.mismatches || below_.meet(t, p_W, along))) {
          scan.hits.push_back(p_W);
          ++frame.below;
        }
        continue;
      }
      if (above <= margin) {
        scan.hits.emplace_back(p_W.x(), p_W.y(), -kJustBelow);
        ++frame.floor;
      } else {
        scan.hits.emplace_back(p_W.x(), p_W.y(), std::max(p_W.z(), -kJustBelow));
        ++((p_W - t).squaredNorm() > reach * reach ? frame.misses : frame.hits);
      }
    }
  }
  return far_below <= options_.most_below_floor * points;
}

MappedFrame DepthMapper::process(double stamp, const DepthImage& image,
                                 const Eigen::Isometry3d& T_WC, Localization pose,
                                 const MotionInView* motion) {
  ProcessorStopwatch clock;
  MappedFrame out;
  out.stamp = stamp;
  if (poses_.any()) out.T_WC = poses_.last();
  const auto reject = [&out](const char* why) {
    if (why != nullptr) add_reason(out.reason, why);
    out.state = Mapping::kRejected;
    return out;
  };
  if (!std::isfinite(stamp)) return reject("the time is not a number");
  const double dt = stamp - last_stamp_;
  if (any_stamp_ && !(dt > 0.0)) return reject("the time does not increase");
  const bool gap = any_stamp_ && period_ > 0.0 && dt > options_.max_gap * period_;
  if (any_stamp_) {
    period_ = period_ > 0.0 ? std::clamp(dt, 0.9 * period_, 1.1 * period_) : dt;
  }
  last_stamp_ = stamp;
  any_stamp_ = true;

  out.state = Mapping::kOk;
  const char* problem = poses_.problem(stamp, T_WC);
  if (problem == nullptr) problem = not_mapped_at(pose);
  const bool sound =
      check_image(image, problem == nullptr ? std::optional(T_WC) : std::nullopt, out);
  out.times.check = clock.lap();
  if (!sound) return reject(nullptr);
  if (problem != nullptr) return reject(problem);
  if (gap) {
    add_reason(out.reason, "frames are missing");
    out.state = Mapping::kDegraded;
  }
  out.T_WC = T_WC;
  out.ground = find_ground(camera_, image,
                           ground_prior(T_WC, options_.height_tolerance, options_.tilt_tolerance),
                           options_.ground);
  if (!out.ground.found) {
    add_reason(out.reason, "no ground: " + out.ground.reason);
    out.state = Mapping::kDegraded;
  }
  correct(out);
  out.times.ground = clock.lap();
  DepthScan scan;
  std::vector<char> moving;
  if (motion != nullptr && !motion->moving.empty()) moving = find_moving(image, out, *motion);
  const bool plausible = make_scan(image, moving, out, scan);
  out.times.scan = clock.lap();
  if (!plausible) {
    out.hits = out.floor = out.misses = out.below = out.moving = 0;
    return reject("too much lies below the floor");
  }
  poses_.accept(stamp, T_WC);
  if (movers_) movers_->look(stamp, *map_, scan);
  map_->insert(scan);
  out.times.insert = clock.lap();
  return out;
}

}  // namespace prospect
