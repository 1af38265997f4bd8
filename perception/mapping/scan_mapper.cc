// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/scan_mapper.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>
#include <utility>

#include "engine/support/stopwatch.h"
#include "models/knobs.h"
#include "models/reason.h"
#include "perception/odometry/lattice_cell.h"

namespace prospect {
namespace {

constexpr double kFarBelow = 0.2;    // [m]: no noise of a floor
constexpr double kJustBelow = 1e-6;  // [m]

}  // namespace

ScanMapper::ScanMapper(const ScanMapperOptions& options, std::shared_ptr<OccupancyMapper> map,
                       std::shared_ptr<MoverTracker> movers)
    : options_(options),
      map_(map ? std::move(map) : std::make_shared<OccupancyMapper>(options.map)),
      movers_(std::move(movers)),
      poses_({options.max_speed, options.max_turn_rate, kFarthestVoxel * options.map.resolution}) {
  check_knobs("scan mapper", options);
}

/// False if too much lies below the floor.
bool ScanMapper::make_scan(const DepthScan& scan_S, const Eigen::Isometry3d& T_WS,
                           MappedFrame& frame, DepthScan& scan) const {
  const Eigen::Vector3d t = T_WS.translation();
  const double reach = std::min(options_.map.max_range, scan_S.reach);
  scan.origin = t;
  scan.reach = reach;
  std::unordered_set<std::uint64_t> cubes;
  const auto first_in_its_cube = [&](const Eigen::Vector3d& p) {
    return cubes.insert(lattice_cell(p, options_.point_spacing * options_.map.resolution)).second;
  };
  int points = 0, far_below = 0;
  for (const Eigen::Vector3d& p : scan_S.hits) {
    if (!p.allFinite()) continue;
    const Eigen::Vector3d p_W = T_WS * p;
    const double range = (p_W - t).norm();
    if (!(range > 0.0)) continue;
    ++points;
    far_below += p_W.z() < -kFarBelow;
    const bool below = p_W.z() < -std::max(options_.floor_margin, map_->options().slice.step);
    if (p_W.z() < -options_.floor_margin && !below) continue;
    if (range > reach) {
      const Eigen::Vector3d seen = t + reach / range * (p_W - t);
      if (!first_in_its_cube(seen)) continue;
      scan.misses.push_back(p_W);
      ++frame.misses;
    } else if (below) {
      if (!first_in_its_cube(p_W)) continue;
      scan.hits.push_back(p_W);
      ++frame.below;
    } else if (p_W.z() <= options_.floor_margin) {
      const Eigen::Vector3d flat(p_W.x(), p_W.y(), -kJustBelow);
      if (!first_in_its_cube(flat)) continue;
      scan.hits.push_back(flat);
      ++frame.floor;
    } else {
      if (!first_in_its_cube(p_W)) continue;
      scan.hits.push_back(p_W);
      ++frame.hits;
    }
  }
  for (const Eigen::Vector3d& p : scan_S.misses) {
    if (!p.allFinite() || !(p.norm() > 0.0)) continue;
    scan.misses.push_back(T_WS * p);
    ++frame.misses;
  }
  return far_below <= options_.most_below_floor * points;
}

MappedFrame ScanMapper::process(double stamp, const DepthScan& scan_S,
                                const Eigen::Isometry3d& T_WS, Localization pose) {
  ProcessorStopwatch clock;
  MappedFrame out;
  out.stamp = stamp;
  out.valid = 1.0;
  if (poses_.any()) out.T_WC = poses_.last();
  const auto reject = [&out](const char* why) {
    add_reason(out.reason, why);
    out.state = Mapping::kRejected;
    out.hits = out.floor = out.misses = out.below = 0;
    return out;
  };
  if (!std::isfinite(stamp)) return reject("the time is not a number");
  if (any_stamp_ && !(stamp > last_stamp_)) return reject("the time does not increase");
  last_stamp_ = stamp;
  any_stamp_ = true;
  const char* problem = poses_.problem(stamp, T_WS);
  const char* const unsure = not_mapped_at(pose);
  const bool known = problem == nullptr && unsure == nullptr;
  if (problem == nullptr && scan_S.hits.empty() && scan_S.misses.empty()) {
    problem = "the scan has no valid range";
  }
  const bool same = !scan_S.hits.empty() && scan_S.hits == last_hits_;
  if (!same) last_hits_ = scan_S.hits;
  const bool hangs = repeated_.hangs(same, known ? std::optional(T_WS) : std::nullopt);
  if (problem == nullptr && hangs) problem = "the scan is frozen";
  if (problem == nullptr) problem = unsure;
  out.times.check = clock.lap();
  if (problem != nullptr) return reject(problem);
  DepthScan scan;
  const bool plausible = make_scan(scan_S, T_WS, out, scan);
  out.times.scan = clock.lap();
  if (!plausible) return reject("too much lies below the floor");
  out.state = Mapping::kOk;
  out.T_WC = T_WS;
  poses_.accept(stamp, T_WS);
  if (movers_) movers_->look(stamp, *map_, scan);
  map_->insert(scan);
  out.times.insert = clock.lap();
  return out;
}

}  // namespace prospect
