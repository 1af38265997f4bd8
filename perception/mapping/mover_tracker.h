// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/maps/grid.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/movers.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

class Knobs;

struct MoverTrackerOptions {
  bool enabled = true;        ///< false: whatever a ray meets is of the building
  double moved = 0.3;         ///< [m] from where it was: what has gone as far moves
  double stands_after = 1.0;  ///< [s] for which what has come is not taken for the building
  double rests_after = 3.0;   ///< [s] what has moved no farther for as long is of the building
  double largest = 1.2;       ///< [m] across: what is larger is no mover
  double acceleration = 1.0;  ///< [m/s^2] one sigma of how a mover's velocity changes in a second
  double spread = 0.3;        ///< [m/s] by which what is predicted grows at least
  double keep = 10.0;  ///< [s] for which one that stood and is not seen any more is remembered
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, MoverTrackerOptions& options);

/// Tells what moves in scans from the building, and follows it.
///
/// What is new. A hit at the body's heights (HeightSlice) in a ground cell that is free, or became
/// occupied within `stands_after`, is of something that was not there before: the building does not
/// come. But a pose that is off moves its walls by a cell, so none of the cells about it may have
/// been occupied for longer, or ever since it is known. Neighbouring cells of such hits, up to two
/// cells apart, are one thing; its position is the mean of its cells, its radius reaches the
/// farthest of them.
///
/// Tracks. Each thing continues the nearest track within reach of it, or begins one. A track is a
/// Kalman filter of constant velocity in the plane,
///   x = (p, v),   p <- p + v dt,   cov += W W' acceleration^2 dt^2,   W = (dt/2, 1),
/// measured with one sigma of a cell. The spread of its Mover is that of v's sigma and
/// options.spread.
///
/// Who is not seen any more, beside the robot or out of view, has not gone: who walked is predicted
/// for two seconds, and may be anywhere then; who stood is there until a ray at the body's heights
/// passes through that place, or for options.keep.
///
/// What becomes of the hits. What is new may be a chair leg that no ray had met yet, or furniture
/// where the estimate has drifted: its hits are entered as any. Once it has moved by options.moved
/// its hits clear up to them and are no obstacle of the map (DepthScan::passing), and movers()
/// tells of it, so that nobody drives into it. What has not moved as far for `rests_after` is of
/// the building again until it goes. So of who walks the first steps are in the map at most, until
/// a ray clears them; who stands is gone round, and nobody waits for ever.
///
/// Frames: W, in which the map may be corrected; what is followed then is off for as long as it is
/// followed. Thread-safety: one thread. Errors: none; non-finite points say nothing. Deterministic.
/// Source: free space that is seen occupied tells what moves (Dynablox, Schmid et al. 2023); the
/// rules for what stands are ours.
class MoverTracker {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit MoverTracker(const MoverTrackerOptions& options = {});

  /// Before a scan of `stamp` [s], in W, is entered into the map: moves the hits of movers to
  /// scan.passing.
  void look(double stamp, OccupancyMapper& map, DepthScan& scan);

  /// Those that have moved, as predicted for `stamp` [s]; null: none.
  std::shared_ptr<const Movers> movers(double stamp) const;

 private:
  struct Thing {
    Eigen::Vector2d position;
    double radius;
    std::vector<Cell> cells;
  };
  struct Track {
    Eigen::Vector4d x = Eigen::Vector4d::Zero();
    Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
    double radius = 0.0;                             // [m]
    double stamp = 0.0;                              // [s] of x
    double seen = 0.0;                               // [s] when it last was
    Eigen::Vector2d home = Eigen::Vector2d::Zero();  // from where it has to move
    double home_since = 0.0;                         // [s]
    bool has_moved = false;                          // else it is of the building
    Mover mover(double spread) const;
  };

  /// Whether what is seen in an occupied cell has come just now.
  bool has_come(Cell cell) const;
  bool is_new(const GroundMap& ground, Cell cell) const;
  std::vector<Thing> things(const GroundMap& ground, std::span<const Cell> cells) const;
  void predict(Track& track, double stamp) const;
  /// Whether a ray passes through where a track is.
  static bool seen_through(const Track& track, const HeightSlice& slice, const DepthScan& scan,
                           double resolution);
  void measure(Track& track, const Thing& thing, double sigma) const;
  /// The track that goes on with a thing, at its time; none: -1.
  int track_of(const Thing& thing, const std::vector<char>& taken) const;
  /// [s] for which one that is not seen is.
  double remembered(const Track& track) const;
  void judge(Track& track, double stamp) const;

  /// Enters what hits free cells and is not held back.
  void note_what_came(const GroundMap& ground, const OccupancyMapper& map, const DepthScan& scan);

  MoverTrackerOptions options_;
  /// When something was first seen in a cell that was free [s].
  std::unordered_map<std::uint64_t, double> came_;
  std::vector<Track> tracks_;
  double stamp_ = -std::numeric_limits<double>::infinity();
};

}  // namespace prospect
