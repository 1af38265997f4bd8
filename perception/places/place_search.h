// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <queue>
#include <string_view>
#include <vector>

#include "engine/maps/planar_move.h"
#include "perception/mapping/map_evidence.h"
#include "perception/places/submap_surface.h"

namespace prospect {

/// A map from above, for PlaceSearch: of each cell of kCell which directions walls face within one
/// cell of it, whether one is in it, and whether it is free: seen through, with no wall within two
/// cells.
///
/// Thread-safety: concurrent reads are safe.
class PlaceRaster {
 public:
  static constexpr double kCell = 0.1;  ///< [m]
  static constexpr int kSectors = 16;   ///< of directions

  /// Evidence of a part of the map and its walls, at `to_map` in it. All before build().
  void add(const MapEvidence& evidence, const SubmapSurface& surface, const PlanarMove& to_map,
           double r, const EvidenceTable& table);
  void build();
  bool empty() const { return cells_.empty(); }
  /// Middles of the cells that are free [m].
  std::vector<Eigen::Vector2d> free() const;

 private:
  friend class PlaceSearch;
  /// Of a square of 2^level cells, from (i, j) on.
  struct Cell {
    std::uint16_t walls = 0;  ///< directions that walls face anywhere in it
    bool wall = false;        ///< in it, of level 0
    bool free = false;        ///< all of it
    bool known = false;       ///< any of it
  };
  static constexpr int kLevels = 6;

  const Cell& at(int level, int i, int j) const;

  std::vector<Eigen::Vector3i> walls_;  ///< i, j, sector
  std::vector<Eigen::Vector2i> seen_;   ///< through
  int low_[2] = {0, 0}, size_[2] = {0, 0};
  std::vector<std::vector<Cell>> cells_;  ///< of each level
};

/// Where a submap lies in a map, if nothing is known of it before: all places at which its walls
/// fit, by branch and bound, so none is missed. Of a move x = (place of the centre, yaw)
///   score(x) = 1/N sum_i s_i(x),   s_i = 1 where a wall faces alike, -1 where it is free, else 0,
/// over N places of the submap's walls, at most kMost, and moves a cell and kTurn apart; less 1/N
/// for each wall of the map that the submap has seen through. The sum of the most that each s_i can
/// be anywhere in a square bounds it from above (PlaceRaster's levels).
///
/// The places are the best, and those less good by at most kRival that lie kApart from all better
/// ones: more than one is an ambiguity, as between rooms that are alike or along a corridor.
/// kRival: with one wall of ten independent, each as it should be in nine cases of ten, the odds
/// against it are then 700.
///
/// Source: ours; Olson's correlative matching, bounded as in Cartographer (Hess et al. 2016), with
/// directions of walls and free space. Deterministic. Never throws.
class PlaceSearch {
 public:
  static constexpr std::size_t kMost = 400;
  static constexpr double kTurn = 0.03;       ///< [rad]
  static constexpr double kLeastScore = 0.6;  ///< below, it is nowhere in the map
  static constexpr double kRival = 0.15;
  static constexpr double kApart = 0.6;  ///< [m], a radian counted as 2 m
  static constexpr std::size_t kMostPlaces = 8;
  static constexpr long kMostLookups = 400'000'000;

  struct Place {
    PlanarMove move;  ///< of the submap onto the map
    double score = 0.0;
  };
  enum class State : std::uint8_t { kSearching, kNowhere, kUnique, kAmbiguous };

  /// walls, free: of the submap (SubmapSurface::walls(), PlaceRaster::free()). centre: where the
  /// robot is in it, which is somewhere that the map knows. `map` must outlive it.
  PlaceSearch(const PlaceRaster& map, const std::vector<SubmapSurface::Wall>& walls,
              const std::vector<Eigen::Vector2d>& free, const Eigen::Vector2d& centre);

  /// Goes on, about so many look-ups in the raster.
  State go_on(long lookups);
  State state() const { return state_; }
  /// Best first, as far as they are found.
  const std::vector<Place>& places() const { return places_; }

 private:
  struct Point {
    std::int16_t i = 0, j = 0;
    std::uint16_t alike = 0;  ///< directions of walls that would face alike
  };
  struct Node {
    float bound = 0.0F;
    std::int16_t yaw = 0, level = 0;  ///< -1: a cell whose score is known
    std::int32_t i = 0, j = 0;
    bool operator<(const Node& other) const;
  };
  void begin_yaw(int yaw);
  float bound(const Node& node) const;
  float seen_through(const Node& node) const;
  void branch(const Node& node);
  bool is_met(const Node& node) const;
  PlanarMove move_of(const Node& node) const;

  const PlaceRaster& map_;
  Eigen::Vector2d centre_;
  std::vector<Eigen::Vector4d> walls_;       ///< place about the centre, direction, either
  std::vector<Eigen::Vector2d> free_;        ///< about the centre
  std::vector<std::vector<Point>> rotated_;  ///< of each yaw
  int yaws_ = 0, begun_ = 0;
  std::priority_queue<Node> open_;
  std::vector<Place> places_;
  State state_ = State::kSearching;
  mutable long lookups_ = 0;
};

}  // namespace prospect
