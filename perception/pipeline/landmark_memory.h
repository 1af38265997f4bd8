// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>

#include "engine/maps/landmark_map.h"
#include "engine/maps/place_moves.h"

namespace prospect {

/// Landmarks that an odometry has forgotten, as it does soon after they have left the view: where
/// they were there is texture, and a planner that asks what it would see elsewhere must know.
///
/// Cells of 0.25 m in W hold what was last seen in each: about what a cell of the image sees 3 m
/// away, in which the odometry keeps one landmark. A landmark is where the robot believed it
/// to be then; it moves with what the map is corrected by (follow()). At most `most` are kept,
/// those seen last. Thread-safety: one thread; maps never change. Deterministic. Source: ours.
class LandmarkMemory {
 public:
  explicit LandmarkMemory(std::size_t most = 4000) : most_(most) {}

  /// Enters the landmarks that the odometry holds now, placed in W.
  void add(const LandmarkMap& now);
  /// `now`, and those remembered in other cells; with how crowded they are together
  /// (landmarks_per_cell.h).
  std::shared_ptr<const LandmarkMap> with_remembered(const LandmarkMap& now) const;

  /// The places of what is remembered have moved.
  void follow(const PlaceMoves& moves);

  std::size_t size() const { return cells_.size(); }

 private:
  struct Seen {
    Landmark landmark;
    std::uint64_t when = 0;
  };
  std::size_t most_;
  std::uint64_t time_ = 0;
  std::unordered_map<std::uint64_t, Seen> cells_;
};

}  // namespace prospect
