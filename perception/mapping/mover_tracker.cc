// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/mover_tracker.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <tuple>

#include "models/knobs.h"

namespace prospect {
namespace {

constexpr double kFirstSpeed = 1.0;      // [m/s] one sigma of a velocity that nobody has measured
constexpr double kWalksOn = 2.0;         // [s] unseen: then they may be anywhere
constexpr double kInTheMap = 1.0;        // [s] unseen, of what is entered into the map meanwhile
constexpr double kWalks = 0.3;           // [m/s]
constexpr double kLeastRadius = 0.25;    // [m] of somebody
constexpr double kMostStep = 0.5;        // [m] from where a thing was expected to where it is
constexpr int kApart = 2;                // [cells] between neighbours of one thing
constexpr std::size_t kMostCells = 500;  // more that are new: the pose is off, or the map
constexpr double kMostSpreads = 2.0;     // what grows faster says nothing

std::uint64_t key(Cell c) {
  return std::uint64_t{static_cast<std::uint32_t>(c.i)} << 32 | static_cast<std::uint32_t>(c.j);
}

bool before(Cell a, Cell b) { return std::tie(a.j, a.i) < std::tie(b.j, b.i); }

void keep_each_once(std::vector<Cell>& cells) {
  std::sort(cells.begin(), cells.end(), before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

/// Over the floor there.
bool at_body_heights(const OccupancyMapper& map, const Eigen::Vector3d& p) {
  const HeightSlice& slice = map.options().slice;
  // The floor rises at most, and comparisons with NaN are false.
  if (!(p.z() >= slice.z_min) || !p.allFinite()) return false;
  const double z = p.z() - map.floor_level(p.head<2>());
  return z >= slice.z_min && z <= slice.z_max;
}

/// The cells of hits at the body's heights, each once.
std::vector<Cell> cells_at_body_heights(const OccupancyMapper& map, const GridFrame& frame,
                                        const std::vector<Eigen::Vector3d>& hits) {
  std::vector<Cell> cells;
  // Hits that follow each other are often in one.
  const double within = (0.5 - 1e-6) * frame.resolution;
  Eigen::Vector2d center = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  for (const Eigen::Vector3d& p : hits) {
    if (std::abs(p.x() - center.x()) < within && std::abs(p.y() - center.y()) < within) continue;
    if (!at_body_heights(map, p)) continue;
    cells.push_back(frame.cell(p.x(), p.y()));
    center = frame.center(cells.back());
  }
  keep_each_once(cells);
  return cells;
}

}  // namespace

MoverTracker::MoverTracker(const MoverTrackerOptions& options) : options_(options) {
  check_knobs("mover tracker", options);
}

Mover MoverTracker::Track::mover(double spread) const {
  const double sigma = std::sqrt(std::max(P(2, 2), P(3, 3)));
  Mover m;
  m.position = x.head<2>();
  m.velocity = x.tail<2>();
  m.radius = std::max(radius, kLeastRadius);
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
  if (track.seen < track.stamp && !track.walks()) {
    track.x.tail<2>().setZero();
    track.stamp = stamp;
    return;
  }
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

bool MoverTracker::seen_through(const Disc& disc, bool whole, const HeightSlice& slice,
                                const DepthScan& scan, double resolution) {
  const Eigen::Vector2d from = scan.origin.head<2>(), to_center = disc.center - from;
  const double half = 0.5 * disc.radius, middle = std::max(half, resolution);
  bool left = false, right = false, between = false;
  const auto note = [&](const Eigen::Vector3d& p, double length) {
    const Eigen::Vector2d ray = p.head<2>() - from;
    const double ahead = ray.dot(to_center);
    const double across = ray.x() * to_center.y() - ray.y() * to_center.x();
    const double squared = ray.squaredNorm(), most = std::max(middle, disc.radius);
    if (!(ahead > 0.0) || !(across * across < most * most * squared)) return;
    const double unit = std::sqrt(squared);
    const double reached = std::isfinite(length) ? std::max(length, 0.0) : unit;
    if (!(ahead / unit + disc.radius < reached)) return;
    const double z = scan.origin.z() + (p.z() - scan.origin.z()) * ahead / squared;
    if (!(z >= slice.z_min && z <= slice.z_max)) return;
    const double side = across / unit;
    left |= side <= -half;
    right |= side >= half;
    between |= std::abs(side) < middle;
  };
  for (const Eigen::Vector3d& p : scan.hits) note(p, (p - scan.origin).head<2>().norm());
  for (const Eigen::Vector3d& p : scan.misses) note(p, scan.reach);
  return between && (!whole || (left && right));
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

std::vector<int> MoverTracker::tracks_of(std::span<const Thing> things) const {
  std::vector<int> found(things.size(), -1);
  std::vector<char> taken(tracks_.size(), 0);
  const auto far = [&](std::size_t thing, std::size_t track) {
    return (tracks_[track].x.head<2>() - things[thing].position).norm();
  };
  const auto pair = [&](std::size_t thing, std::size_t track) {
    found[thing] = static_cast<int>(track);
    taken[track] = 1;
  };
  // Nobody who stands is to be taken for who walks by.
  for (;;) {
    double nearest = kMostStep;
    std::size_t thing = 0, track = tracks_.size();
    for (std::size_t i = 0; i < things.size(); ++i) {
      for (std::size_t n = 0; n < tracks_.size(); ++n) {
        if (found[i] >= 0 || taken[n] || !tracks_[n].is_somebody() || !(far(i, n) < nearest))
          continue;
        nearest = far(i, n);
        thing = i;
        track = n;
      }
    }
    if (track == tracks_.size()) break;
    pair(thing, track);
  }
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (found[i] >= 0) continue;
    double nearest = kMostStep;
    std::size_t track = tracks_.size();
    for (std::size_t n = 0; n < tracks_.size(); ++n) {
      if (taken[n] || !(far(i, n) < nearest)) continue;
      nearest = far(i, n);
      track = n;
    }
    if (track < tracks_.size()) pair(i, track);
  }
  return found;
}

MoverTracker::Track MoverTracker::begin(const Thing& thing, double stamp, double sigma) const {
  Track track;
  track.x << thing.position, Eigen::Vector2d::Zero();
  const double first = kFirstSpeed * kFirstSpeed;
  track.P = Eigen::Vector4d(sigma * sigma, sigma * sigma, first, first).asDiagonal();
  track.radius = thing.radius;
  track.first = track.home = thing.position;
  track.stamp = track.home_since = stamp;
  track.has_moved = std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& t) {
    return t.is_somebody() && (t.x.head<2>() - thing.position).norm() < kMostStep;
  });
  return track;
}

bool MoverTracker::Track::walks() const { return x.tail<2>().norm() > kWalks; }

double MoverTracker::remembered(const Track& track) const {
  if (!track.is_somebody()) return std::min(kInTheMap, options_.keep);
  return track.walks() ? std::min(kWalksOn, options_.keep) : options_.keep;
}

bool MoverTracker::rests(const Track& track, double stamp) const {
  return stamp - track.home_since > options_.rests_after && !track.walks();
}

void MoverTracker::judge(Track& track, const HeightSlice& slice, const DepthScan& scan,
                         double resolution) const {
  const Eigen::Vector2d at = track.x.head<2>();
  if ((at - track.home).norm() > options_.moved) {
    track.home = at;
    track.home_since = track.stamp;
    track.has_moved = true;
  } else if (track.stamp - track.home_since > options_.rests_after) {
    track.has_moved = false;
  }
  if (track.walked || !track.has_moved) return;
  track.walked = (at - track.first).norm() > track.radius + resolution &&
                 seen_through({track.first, 0.5 * track.radius}, false, slice, scan, resolution);
}

void MoverTracker::look(double stamp, OccupancyMapper& map, DepthScan& scan) {
  if (!options_.enabled || !std::isfinite(stamp)) return;
  const std::shared_ptr<const GroundMap> so_far = map.ground();
  const GroundMap& ground = *so_far;
  const HeightSlice& slice = map.options().slice;
  stamp_ = stamp = std::max(stamp_, stamp);
  for (Track& track : tracks_) predict(track, stamp);
  const double r = ground.frame().resolution;
  const std::vector<Cell> met = cells_at_body_heights(map, ground.frame(), scan.hits);
  std::vector<Cell> cells;
  std::copy_if(met.begin(), met.end(), std::back_inserter(cells),
               [&](Cell cell) { return is_new(ground, cell); });
  add_cells_of_movers(map, ground, scan, cells);
  if (cells.size() > kMostCells) cells.clear();

  const std::vector<Thing> seen = things(ground, cells);
  std::vector<Disc> held;
  const std::vector<int> tracks = tracks_of(seen);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const bool begins = tracks[i] < 0;
    if (begins) tracks_.push_back(begin(seen[i], stamp, r));
    Track& track = begins ? tracks_.back() : tracks_[static_cast<std::size_t>(tracks[i])];
    if (!begins) measure(track, seen[i], r);
    track.seen = stamp;
    judge(track, slice, scan, r);
    if (track.is_somebody()) held.push_back({seen[i].position, seen[i].radius});
  }
  std::erase_if(tracks_, [&](const Track& t) {
    if (stamp - t.seen > remembered(t)) return true;
    // Of what is in the map a ray will do; of somebody seen in part the rest may be there.
    const Disc disc{t.x.head<2>(), t.is_somebody() ? std::max(t.radius, kLeastRadius) : t.radius};
    return stamp > t.seen && seen_through(disc, t.is_somebody(), slice, scan, r);
  });
  // Of several who are too near to each other to be things, too.
  for (const Track& track : tracks_) {
    if (track.is_somebody()) held.push_back({track.x.head<2>(), track.radius});
  }
  if (held.empty()) return note_what_came(ground, met);
  // All of somebody, from the feet to the head, at whatever height the body looks for it.
  const auto is_held = [&](const Eigen::Vector3d& p) {
    if (!(p.z() > 0.0)) return false;
    const Cell cell = ground.frame().cell(p.x(), p.y());
    if (ground.state(cell) == CellState::kOccupied && !has_come(cell)) return false;
    return std::any_of(held.begin(), held.end(), [&](const Disc& d) {
      return (d.center - p.head<2>()).norm() < d.radius + r;
    });
  };
  const auto first = std::stable_partition(scan.hits.begin(), scan.hits.end(),
                                           [&](const Eigen::Vector3d& p) { return !is_held(p); });
  scan.passing.insert(scan.passing.end(), first, scan.hits.end());
  scan.hits.erase(first, scan.hits.end());
  note_what_came(ground, cells_at_body_heights(map, ground.frame(), scan.hits));
}

void MoverTracker::add_cells_of_movers(const OccupancyMapper& map, const GroundMap& ground,
                                       const DepthScan& scan, std::vector<Cell>& cells) const {
  const double r = ground.frame().resolution;
  for (const Track& track : tracks_) {
    if (!track.is_somebody()) continue;
    for (const Eigen::Vector3d& p : scan.hits) {
      if (!((track.x.head<2>() - p.head<2>()).norm() < track.radius + r)) continue;
      if (!at_body_heights(map, p)) continue;
      const Cell cell = ground.frame().cell(p.x(), p.y());
      if (ground.state(cell) != CellState::kOccupied) cells.push_back(cell);
    }
  }
  keep_each_once(cells);
}

void MoverTracker::note_what_came(const GroundMap& ground, std::span<const Cell> met) {
  for (const Cell cell : met) {
    if (ground.state(cell) == CellState::kFree) came_[key(cell)] = stamp_;
  }
}

std::shared_ptr<const Movers> MoverTracker::movers(double stamp) const {
  auto known = std::make_shared<Movers>();
  known->stamp = stamp;
  for (const Track& track : tracks_) {
    if (!track.is_somebody() || stamp - track.seen > remembered(track)) continue;
    Mover mover = track.mover(options_.spread);
    if (rests(track, stamp)) mover.velocity.setZero(), mover.spread = 0.0;
    known->all.push_back(mover.after(std::max(0.0, stamp - track.stamp)));
  }
  if (known->all.empty()) return nullptr;
  return known;
}

std::shared_ptr<const GroundMap> MoverTracker::with_who_rests(
    double stamp, std::shared_ptr<const GroundMap> ground) const {
  std::shared_ptr<GroundMap> among;
  const GridFrame frame = ground->frame();
  for (const Track& track : tracks_) {
    if (!track.is_somebody() || !rests(track, stamp)) continue;
    if (stamp - track.seen > remembered(track)) continue;
    if (!among) among = std::make_shared<GroundMap>(*ground);
    const Eigen::Vector2d at = track.x.head<2>();
    const double radius = std::max(track.radius, kLeastRadius);
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(radius);
    const Eigen::Vector2d low = at - reach, high = at + reach;
    const Cell first = frame.cell(low.x(), low.y()), last = frame.cell(high.x(), high.y());
    for (int j = first.j; j <= last.j; ++j) {
      for (int i = first.i; i <= last.i; ++i) {
        const bool in_reach = (frame.center({i, j}) - at).norm() < radius;
        if (in_reach && ground->state({i, j}) == CellState::kFree) {
          among->set({i, j}, CellState::kOccupied, false);
        }
      }
    }
  }
  if (!among) return ground;
  return among;
}

}  // namespace prospect
