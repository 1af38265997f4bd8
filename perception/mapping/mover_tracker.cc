// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/mover_tracker.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <tuple>

#include "models/knobs.h"

namespace prospect {
namespace {

constexpr double kFirstSpeed = 1.0;      // [m/s] one sigma of a velocity that nobody has measured
constexpr double kWalksOn = 2.0;         // [s] unseen: then they may be anywhere
constexpr double kInTheMap = 1.0;        // [s] unseen, of what is entered into the map meanwhile
constexpr double kWalks = 0.3;           // [m/s]
constexpr double kMostStep = 0.5;        // [m] from where a thing was expected to where it is
constexpr int kApart = 2;                // [cells] between neighbours of one thing
constexpr std::size_t kMostCells = 500;  // more that are new: the pose is off, or the map
constexpr double kMostSpreads = 2.0;     // what grows faster says nothing

std::uint64_t key(Cell c) {
  return std::uint64_t{static_cast<std::uint32_t>(c.i)} << 32 | static_cast<std::uint32_t>(c.j);
}

/// Over the floor there.
bool at_body_heights(const OccupancyMapper& map, const Eigen::Vector3d& p) {
  if (!p.allFinite()) return false;
  const HeightSlice& slice = map.options().slice;
  const double z = p.z() - map.floor_level(p.head<2>());
  return z >= slice.z_min && z <= slice.z_max;
}

bool before(Cell a, Cell b) { return std::tie(a.j, a.i) < std::tie(b.j, b.i); }

}  // namespace

MoverTracker::MoverTracker(const MoverTrackerOptions& options) : options_(options) {
  check_knobs("mover tracker", options);
}

Mover MoverTracker::Track::mover(double spread) const {
  const double sigma = std::sqrt(std::max(P(2, 2), P(3, 3)));
  Mover m;
  m.position = x.head<2>();
  m.velocity = x.tail<2>();
  m.radius = radius;
  m.spread = std::clamp(sigma, spread, kMostSpreads * spread);
  return m;
}

bool MoverTracker::has_come(Cell cell) const {
  const auto since = came_.find(key(cell));
  return since != came_.end() && stamp_ - since->second <= options_.stands_after;
}

bool MoverTracker::is_new(const GroundMap& ground, Cell cell) const {
  if (ground.state(cell) == CellState::kOccupied && !has_come(cell)) return false;
  if (ground.state(cell) == CellState::kUnknown) return false;
  for (int dj = -1; dj <= 1; ++dj) {
    for (int di = -1; di <= 1; ++di) {
      const Cell beside{cell.i + di, cell.j + dj};
      if (ground.state(beside) == CellState::kOccupied && !has_come(beside)) return false;
    }
  }
  return true;
}

std::vector<MoverTracker::Thing> MoverTracker::things(const GroundMap& ground,
                                                      std::span<const Cell> cells) const {
  std::vector<Thing> found;
  std::vector<char> taken(cells.size(), 0);
  const double half = 0.5 * ground.frame().resolution;
  for (std::size_t first = 0; first < cells.size(); ++first) {
    if (taken[first]) continue;
    Thing thing{Eigen::Vector2d::Zero(), 0.0, {cells[first]}};
    taken[first] = 1;
    for (std::size_t n = 0; n < thing.cells.size(); ++n) {
      const Cell at = thing.cells[n];
      for (std::size_t other = first + 1; other < cells.size(); ++other) {
        const Cell c = cells[other];
        if (taken[other] || std::abs(c.i - at.i) > kApart || std::abs(c.j - at.j) > kApart)
          continue;
        taken[other] = 1;
        thing.cells.push_back(c);
      }
    }
    for (const Cell c : thing.cells) thing.position += ground.frame().center(c);
    thing.position /= static_cast<double>(thing.cells.size());
    for (const Cell c : thing.cells) {
      const double far = (ground.frame().center(c) - thing.position).norm();
      thing.radius = std::max(thing.radius, far + half);
    }
    if (2.0 * thing.radius <= options_.largest) found.push_back(std::move(thing));
  }
  return found;
}

void MoverTracker::predict(Track& track, double stamp) const {
  const double dt = std::max(0.0, stamp - track.stamp);
  if (!(dt > 0.0)) return;
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F(0, 2) = F(1, 3) = dt;
  const double q = options_.acceleration * options_.acceleration * dt * dt;
  track.x = F * track.x;
  track.P = F * track.P * F.transpose();
  for (const int axis : {0, 1}) {
    track.P(axis, axis) += 0.25 * dt * dt * q;
    track.P(axis, axis + 2) += 0.5 * dt * q;
    track.P(axis + 2, axis) += 0.5 * dt * q;
    track.P(axis + 2, axis + 2) += q;
  }
  track.stamp = stamp;
}

bool MoverTracker::seen_through(const Track& track, const HeightSlice& slice, const DepthScan& scan,
                                double resolution) {
  const Eigen::Vector2d from = scan.origin.head<2>(), to_track = track.x.head<2>() - from;
  const double aside = std::max(0.5 * track.radius, resolution);
  const auto passes = [&](const Eigen::Vector3d& p, double length) {
    const Eigen::Vector2d ray = p.head<2>() - from;
    const double unit = ray.norm();
    if (!(unit > 0.0)) return false;
    const double ahead = ray.dot(to_track) / unit;
    const double reached = std::isfinite(length) ? std::max(length, 0.0) : unit;
    if (!(ahead > 0.0 && ahead + track.radius < reached)) return false;
    const double beside = std::abs(ray.x() * to_track.y() - ray.y() * to_track.x()) / unit;
    const double z = scan.origin.z() + (p.z() - scan.origin.z()) * ahead / unit;
    return beside < aside && z >= slice.z_min && z <= slice.z_max;
  };
  const auto any = [&](const std::vector<Eigen::Vector3d>& points, bool missed) {
    return std::any_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
      return passes(p, missed ? scan.reach : (p - scan.origin).head<2>().norm());
    });
  };
  return any(scan.hits, false) || any(scan.misses, true);
}

void MoverTracker::measure(Track& track, const Thing& thing, double sigma) const {
  const Eigen::Matrix2d S =
      track.P.topLeftCorner<2, 2>() + sigma * sigma * Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 4, 2> K = track.P.leftCols<2>() * S.inverse();
  track.x += K * (thing.position - track.x.head<2>());
  track.P -= K * track.P.topRows<2>();
  track.P = (0.5 * (track.P + track.P.transpose())).eval();
  // Of somebody who is seen in part the whole is remembered for a while.
  track.radius = std::max(thing.radius, 0.9 * track.radius);
}

int MoverTracker::track_of(const Thing& thing, const std::vector<char>& taken) const {
  int best = -1;
  double nearest = kMostStep;
  for (std::size_t n = 0; n < tracks_.size(); ++n) {
    const double far = (tracks_[n].x.head<2>() - thing.position).norm();
    if (taken[n] || !(far < nearest)) continue;
    nearest = far;
    best = static_cast<int>(n);
  }
  return best;
}

double MoverTracker::remembered(const Track& track) const {
  if (!track.has_moved) return std::min(kInTheMap, options_.keep);
  const bool walks = track.x.tail<2>().norm() > kWalks;
  return walks ? std::min(kWalksOn, options_.keep) : options_.keep;
}

void MoverTracker::judge(Track& track, double stamp) const {
  if ((track.x.head<2>() - track.home).norm() > options_.moved) {
    track.home = track.x.head<2>();
    track.home_since = stamp;
    track.has_moved = true;
  } else if (stamp - track.home_since > options_.rests_after) {
    track.has_moved = false;
  }
}

void MoverTracker::look(double stamp, OccupancyMapper& map, DepthScan& scan) {
  if (!options_.enabled || !std::isfinite(stamp)) return;
  const std::shared_ptr<const GroundMap> so_far = map.ground();
  const GroundMap& ground = *so_far;
  const HeightSlice& slice = map.options().slice;
  stamp_ = stamp = std::max(stamp_, stamp);
  for (Track& track : tracks_) predict(track, stamp);
  const double r = ground.frame().resolution;
  const auto of_somebody = [&](const Eigen::Vector2d& p) {
    return std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& t) {
      return t.has_moved && (t.x.head<2>() - p).norm() < t.radius + r;
    });
  };
  std::vector<Cell> cells;
  for (const Eigen::Vector3d& p : scan.hits) {
    if (!at_body_heights(map, p)) continue;
    const Cell cell = ground.frame().cell(p.x(), p.y());
    const bool open = ground.state(cell) != CellState::kOccupied;
    if (is_new(ground, cell) || (open && of_somebody(p.head<2>()))) cells.push_back(cell);
  }
  std::sort(cells.begin(), cells.end(), before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  if (cells.size() > kMostCells) cells.clear();

  std::vector<Thing> held;
  std::vector<char> taken(tracks_.size(), 0);
  for (Thing& thing : things(ground, cells)) {
    int n = track_of(thing, taken);
    if (n < 0) {
      Track track;
      track.x << thing.position, Eigen::Vector2d::Zero();
      track.P = Eigen::Vector4d(r * r, r * r, kFirstSpeed * kFirstSpeed, kFirstSpeed * kFirstSpeed)
                    .asDiagonal();
      track.radius = thing.radius;
      track.home = thing.position;
      track.stamp = track.home_since = stamp;
      n = static_cast<int>(tracks_.size());
      tracks_.push_back(track);
      taken.push_back(1);
    } else {
      measure(tracks_[static_cast<std::size_t>(n)], thing, r);
      taken[static_cast<std::size_t>(n)] = 1;
    }
    Track& track = tracks_[static_cast<std::size_t>(n)];
    track.seen = stamp;
    judge(track, stamp);
    if (track.has_moved) held.push_back(std::move(thing));
  }
  std::erase_if(tracks_, [&](const Track& t) {
    return stamp - t.seen > remembered(t) || (stamp > t.seen && seen_through(t, slice, scan, r));
  });
  if (held.empty()) return note_what_came(ground, map, scan);
  // All of somebody, from the feet to the head, at whatever height the body looks for it.
  const auto is_held = [&](const Eigen::Vector3d& p) {
    if (!(p.z() > 0.0)) return false;
    const Cell cell = ground.frame().cell(p.x(), p.y());
    if (ground.state(cell) == CellState::kOccupied && !has_come(cell)) return false;
    return std::any_of(held.begin(), held.end(), [&](const Thing& t) {
      return (t.position - p.head<2>()).norm() < t.radius + r;
    });
  };
  const auto first = std::stable_partition(scan.hits.begin(), scan.hits.end(),
                                           [&](const Eigen::Vector3d& p) { return !is_held(p); });
  scan.passing.insert(scan.passing.end(), first, scan.hits.end());
  scan.hits.erase(first, scan.hits.end());
  note_what_came(ground, map, scan);
}

void MoverTracker::note_what_came(const GroundMap& ground, const OccupancyMapper& map,
                                  const DepthScan& scan) {
  for (const Eigen::Vector3d& p : scan.hits) {
    if (!at_body_heights(map, p)) continue;
    const Cell cell = ground.frame().cell(p.x(), p.y());
    if (ground.state(cell) == CellState::kFree) came_[key(cell)] = stamp_;
  }
}

std::shared_ptr<const Movers> MoverTracker::movers(double stamp) const {
  auto known = std::make_shared<Movers>();
  known->stamp = stamp;
  for (const Track& track : tracks_) {
    if (!track.has_moved || stamp - track.seen > remembered(track)) continue;
    known->all.push_back(track.mover(options_.spread).after(std::max(0.0, stamp - track.stamp)));
  }
  if (known->all.empty()) return nullptr;
  return known;
}

}  // namespace prospect
