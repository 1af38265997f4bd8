// SPDX-License-Identifier: Apache-2.0
#include "perception/places/place_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

namespace prospect {
namespace {

int cell_of(double x) { return static_cast<int>(std::floor(x / PlaceRaster::kCell)); }

int sector_of(double direction) {
  const double turn = direction / (2.0 * M_PI);
  const int n = static_cast<int>(std::lround(turn * PlaceRaster::kSectors));
  return (n % PlaceRaster::kSectors + PlaceRaster::kSectors) % PlaceRaster::kSectors;
}

std::uint16_t bit(int sector) {
  const int n = (sector % PlaceRaster::kSectors + PlaceRaster::kSectors) % PlaceRaster::kSectors;
  return static_cast<std::uint16_t>(1U << n);
}

}  // namespace

void PlaceRaster::add(const MapEvidence& evidence, const SubmapSurface& surface,
                      const PlanarMove& to_map, double r, const EvidenceTable& table) {
  for (const SubmapSurface::Wall& wall : surface.walls()) {
    const Eigen::Vector3d p = to_map(wall.at);
    const int sector = sector_of(std::atan2(wall.normal.y(), wall.normal.x()) + to_map.yaw);
    walls_.emplace_back(cell_of(p.x()), cell_of(p.y()), sector);
    if (wall.either) {
      walls_.emplace_back(cell_of(p.x()), cell_of(p.y()), (sector + kSectors / 2) % kSectors);
    }
  }
  constexpr int kEdge = MapEvidence::kEdge;
  for (const auto& [address, brick] : evidence.bricks()) {
    for (int x = 0; x < kEdge; ++x) {
      for (int y = 0; y < kEdge; ++y) {
        bool free = false;
        for (int z = 0; z < kEdge && !free; ++z) {
          const auto s = brick.states[static_cast<std::size_t>(MapEvidence::voxel(x, y, z))];
          free = s != EvidenceTable::kNothing && !table.is_surface(s);
        }
        if (!free) continue;
        const Eigen::Vector2d p = to_map(Eigen::Vector2d((address[0] * kEdge + x + 0.5) * r,
                                                         (address[1] * kEdge + y + 0.5) * r));
        seen_.emplace_back(cell_of(p.x()), cell_of(p.y()));
      }
    }
  }
}

void PlaceRaster::build() {
  cells_.clear();
  if (walls_.empty()) return;
  int high[2];
  for (int a = 0; a < 2; ++a) {
    low_[a] = std::numeric_limits<int>::max();
    high[a] = std::numeric_limits<int>::min();
    for (const Eigen::Vector3i& w : walls_) {
      low_[a] = std::min(low_[a], w[a] - 1), high[a] = std::max(high[a], w[a] + 1);
    }
    for (const Eigen::Vector2i& s : seen_) {
      low_[a] = std::min(low_[a], s[a]), high[a] = std::max(high[a], s[a]);
    }
    // Squares that begin before it reach into it.
    low_[a] -= 1 << (kLevels - 1);
    size_[a] = high[a] - low_[a] + 1;
  }
  const auto index = [this](int i, int j) {
    return static_cast<std::size_t>(j - low_[1]) * static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(i - low_[0]);
  };
  std::vector<Cell> base(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]));
  for (const Eigen::Vector2i& s : seen_) base[index(s[0], s[1])].free = true;
  for (const Eigen::Vector3i& w : walls_) {
    for (int j = w[1] - 2; j <= w[1] + 2; ++j) {
      for (int i = w[0] - 2; i <= w[0] + 2; ++i) {
        if (i < low_[0] || j < low_[1] || i >= low_[0] + size_[0] || j >= low_[1] + size_[1]) {
          continue;
        }
        Cell& cell = base[index(i, j)];
        cell.free = false;
        cell.known = true;
        const int off = std::max(std::abs(i - w[0]), std::abs(j - w[1]));
        if (off < 2) cell.walls |= bit(w[2]);
        if (off == 0) cell.wall = true;
      }
    }
  }
  for (Cell& cell : base) cell.known = cell.known || cell.free;
  cells_.push_back(std::move(base));
  for (int level = 1; level < kLevels; ++level) {
    const int half = 1 << (level - 1);
    std::vector<Cell> next(cells_.back().size());
    for (int j = low_[1]; j < low_[1] + size_[1]; ++j) {
      for (int i = low_[0]; i < low_[0] + size_[0]; ++i) {
        Cell& cell = next[index(i, j)];
        cell.free = true;
        for (const auto& [x, y] : {std::pair(i, j), std::pair(i + half, j), std::pair(i, j + half),
                                   std::pair(i + half, j + half)}) {
          const Cell& part = at(level - 1, x, y);
          cell.walls |= part.walls;
          cell.free = cell.free && part.free;
          cell.known = cell.known || part.known;
        }
      }
    }
    cells_.push_back(std::move(next));
  }
  walls_ = {};
  seen_ = {};
}

std::vector<Eigen::Vector2d> PlaceRaster::free() const {
  std::vector<Eigen::Vector2d> places;
  for (int j = low_[1]; !cells_.empty() && j < low_[1] + size_[1]; ++j) {
    for (int i = low_[0]; i < low_[0] + size_[0]; ++i) {
      if (at(0, i, j).free) places.emplace_back(kCell * (i + 0.5), kCell * (j + 0.5));
    }
  }
  return places;
}

const PlaceRaster::Cell& PlaceRaster::at(int level, int i, int j) const {
  static const Cell kNothing;
  const int x = i - low_[0], y = j - low_[1];
  if (x < 0 || y < 0 || x >= size_[0] || y >= size_[1]) return kNothing;
  return cells_[static_cast<std::size_t>(level)]
               [static_cast<std::size_t>(y) * static_cast<std::size_t>(size_[0]) +
                static_cast<std::size_t>(x)];
}

bool PlaceSearch::Node::operator<(const Node& other) const {
  // Of equal bounds the finer one first, then by its place: always the same one.
  return std::tie(bound, other.level, other.yaw, other.j, other.i) <
         std::tie(other.bound, level, yaw, j, i);
}

PlaceSearch::PlaceSearch(const PlaceRaster& map, const std::vector<SubmapSurface::Wall>& walls,
                         const std::vector<Eigen::Vector2d>& free, const Eigen::Vector2d& centre)
    : map_(map), centre_(centre), yaws_(static_cast<int>(std::ceil(2.0 * M_PI / kTurn))) {
  // One of each cell and direction, so that walls count by their length.
  std::set<std::tuple<int, int, int>> met;
  for (const SubmapSurface::Wall& wall : walls) {
    const Eigen::Vector2d p = wall.at.head<2>() - centre;
    const double direction = std::atan2(wall.normal.y(), wall.normal.x());
    if (!met.emplace(cell_of(p.x()), cell_of(p.y()), sector_of(direction)).second) continue;
    walls_.emplace_back(p.x(), p.y(), direction, wall.either ? 1.0 : 0.0);
  }
  if (walls_.size() > kMost) {
    for (std::size_t n = 0; n < kMost; ++n) walls_[n] = walls_[n * walls_.size() / kMost];
    walls_.resize(kMost);
  }
  for (const Eigen::Vector2d& p : free) free_.push_back(p - centre);
  rotated_.resize(static_cast<std::size_t>(yaws_));
  if (map_.empty() || walls_.empty()) state_ = State::kNowhere;
}

void PlaceSearch::begin_yaw(int yaw) {
  std::vector<Point>& points = rotated_[static_cast<std::size_t>(yaw)];
  const Eigen::Rotation2Dd turn(yaw * kTurn);
  for (const Eigen::Vector4d& wall : walls_) {
    const Eigen::Vector2d p = turn * Eigen::Vector2d(wall.head<2>());
    const int sector = sector_of(wall[2] + yaw * kTurn);
    Point point;
    // From the middle of the centre's cell.
    point.i = static_cast<std::int16_t>(cell_of(p.x() + 0.5 * PlaceRaster::kCell));
    point.j = static_cast<std::int16_t>(cell_of(p.y() + 0.5 * PlaceRaster::kCell));
    for (int by = -1; by <= 1; ++by) {
      point.alike |= bit(sector + by);
      if (wall[3] > 0.0) point.alike |= bit(sector + by + PlaceRaster::kSectors / 2);
    }
    points.push_back(point);
  }
  constexpr int kTop = PlaceRaster::kLevels - 1;
  const int edge = 1 << kTop;
  for (int j = map_.low_[1]; j < map_.low_[1] + map_.size_[1]; j += edge) {
    for (int i = map_.low_[0]; i < map_.low_[0] + map_.size_[0]; i += edge) {
      Node node;
      node.yaw = static_cast<std::int16_t>(yaw);
      node.level = kTop;
      node.i = i, node.j = j;
      if (!map_.at(kTop, i, j).known) continue;
      node.bound = bound(node);
      if (node.bound >= kLeastScore - kRival) open_.push(node);
    }
  }
}

/// What walls of the map cost that the submap has seen through, if the centre is in that cell.
float PlaceSearch::seen_through(const Node& node) const {
  const Eigen::Rotation2Dd turn(node.yaw * kTurn);
  const Eigen::Vector2d at = PlaceRaster::kCell * Eigen::Vector2d(node.i + 0.5, node.j + 0.5);
  int walls = 0;
  for (const Eigen::Vector2d& free : free_) {
    const Eigen::Vector2d p = at + turn * free;
    walls += map_.at(0, cell_of(p.x()), cell_of(p.y())).wall;
  }
  lookups_ += static_cast<long>(free_.size());
  return static_cast<float>(walls) / static_cast<float>(walls_.size());
}

float PlaceSearch::bound(const Node& node) const {
  int sum = 0;
  const std::vector<Point>& points = rotated_[static_cast<std::size_t>(node.yaw)];
  for (const Point& p : points) {
    const PlaceRaster::Cell& cell = map_.at(node.level, node.i + p.i, node.j + p.j);
    sum += (cell.walls & p.alike) != 0 ? 1 : cell.free ? -1 : 0;
  }
  lookups_ += static_cast<long>(points.size());
  return static_cast<float>(sum) / static_cast<float>(points.size());
}

PlanarMove PlaceSearch::move_of(const Node& node) const {
  const Eigen::Vector2d at = PlaceRaster::kCell * Eigen::Vector2d(node.i + 0.5, node.j + 0.5);
  const double yaw = std::remainder(node.yaw * kTurn, 2.0 * M_PI);
  return {at - Eigen::Rotation2Dd(yaw) * centre_, yaw};
}

/// Whether all of it is near a place that is found.
bool PlaceSearch::is_met(const Node& node) const {
  const PlanarMove move = move_of(node);
  const double half = 0.5 * ((1 << std::max<int>(node.level, 0)) - 1) * PlaceRaster::kCell;
  const Eigen::Vector2d middle = move(centre_) + Eigen::Vector2d(half, half);
  return std::any_of(places_.begin(), places_.end(), [&](const Place& place) {
    const double turn = std::abs(std::remainder(move.yaw - place.move.yaw, 2.0 * M_PI));
    return (place.move(centre_) - middle).norm() + std::sqrt(2.0) * half + 2.0 * turn < kApart;
  });
}

void PlaceSearch::branch(const Node& node) {
  const int half = 1 << (node.level - 1);
  for (int n = 0; n < 4; ++n) {
    Node part = node;
    part.level = static_cast<std::int16_t>(node.level - 1);
    part.i += n % 2 * half;
    part.j += n / 2 * half;
    if (!map_.at(part.level, part.i, part.j).known || is_met(part)) continue;
    part.bound = bound(part);
    if (part.bound >= kLeastScore - kRival) open_.push(part);
  }
}

PlaceSearch::State PlaceSearch::go_on(long lookups) {
  const long until = lookups_ + lookups;
  while (state_ == State::kSearching && lookups_ < until) {
    if (begun_ < yaws_) {
      begin_yaw(begun_++);
      continue;
    }
    const bool enough = open_.empty() || places_.size() == kMostPlaces || lookups_ > kMostLookups ||
                        (!places_.empty() && open_.top().bound < places_.front().score - kRival);
    if (enough) {
      const bool cut_off = lookups_ > kMostLookups && !open_.empty();
      const bool fits = !places_.empty() && places_.front().score >= kLeastScore;
      state_ = !fits                           ? State::kNowhere
               : places_.size() > 1 || cut_off ? State::kAmbiguous
                                               : State::kUnique;
      break;
    }
    const Node node = open_.top();
    open_.pop();
    if (is_met(node)) continue;
    if (node.level < 0) {
      places_.push_back({move_of(node), node.bound});
    } else if (node.level == 0) {
      Node known = node;
      known.level = -1;
      known.bound -= seen_through(node);
      if (known.bound >= kLeastScore - kRival) open_.push(known);
    } else {
      branch(node);
    }
  }
  return state_;
}

}  // namespace prospect
