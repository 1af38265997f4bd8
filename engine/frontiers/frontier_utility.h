// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/frontiers/frontiers.h"
#include "engine/maps/grid.h"
#include "engine/maps/place_moves.h"
#include "engine/maps/traversability.h"
#include "models/types.h"

namespace prospect {

class Knobs;

struct FrontierUtilityOptions {
  double depth = 1.0;    ///< [m] how far behind a frontier its area counts
  double opening = 0.2;  ///< [m] clearance of unknown ground that counts
  double failed_observation =
      0.5;  ///< factor on the confidence of a cell that an observation did not resolve
  double failed_visit = 0.5;  ///< ... near which a visit failed
  double visit_radius = 1.0;  ///< [m] around the target in which a visit counts
  double observation_interval =
      0.4;                    ///< [s] steps closer in time than this count as one observation
  double sensor_range = 4.0;  ///< r_max [m]
  double view_margin = 0.3;   ///< a cell counts as in view within sensor_range - view_margin [m]
  double sensor_fov = 1.047;  ///< horizontal field of view [rad]
  double fov_margin = 0.05;   ///< left out at either side [rad]
  int renewal_cells = 2;      ///< a change this near (Chebyshev) renews the confidence in a cell
  double least_confidence =
      0.5;               ///< share of the best cell's confidence below which one is not led to
  double nearer = 0.75;  ///< share of an observation's distance within which the next one must be
  double nearest = 0.3;  ///< [m] that no observation must be nearer than
};

/// The knobs (models/knobs.h); range and field of view are the depth sensor's.
void describe(Knobs& knobs, FrontierUtilityOptions& options);

/// What a frontier is worth: the area that a look at it is expected to show, learned from what
/// observations have shown.
///
///   A_f = min(view, r^2 |{ c : joined to a cell of the frontier by at most depth / r steps between
///                  4-neighbours, through unknown cells with a clearance of at least `opening` }|)
///   E_f = y(A_f) A_f mean_{c in f} tau_c                                                 [m^2]
///
/// view: the ground in the sensor's field, 1/2 r_max^2 fov, with a fov of 1 rad at least, for a
/// robot turns while it looks. A door of 1 m and the end of a corridor promise several square
/// metres, a slit through which a room is seen one or two. The sliver that a corner hid, the rim of
/// a wall and a hole that noise left in it promise next to nothing, however long they are.
///
/// tau_c in (0, 1] is the confidence in cell c, 1 at first:
///   * in view of an observation from a distance d and unknown all the same: times
///   failed_observation^w,
///     w = min(1, 2 - 2 d / r_max): beyond half the range an observation tells less of the cell. It
///     tells that the cell is not seen from there: the next one must be from max(nearest, nearer
///     d);
///   * within visit_radius of a target that was given up, for want of progress or because
///     localization was lost near it: times failed_visit;
///   * ground within renewal_cells that becomes known renews it: tau_c = 1, at any distance. Known
///   ground there that
///     changes (free to occupied or back) does so by half as much each time, tau_c = 1/2, 1/4, ...
///     at most: noise flips cells for ever.
/// y(A) in (0, 1] is the yield of frontiers of that size: what targets have shown of what they
/// promised, by octaves of A from 1/2 to 4 m^2, the newest counting a fifth. It begins at 1/2 below
/// 2 m^2 and at 1 above: behind a sliver there is a wall more often than a room.
///
/// So whatever does not show anything is left in the end, what promises much is tried more often,
/// and nothing is tried for ever. In view: within range and field of view of the pose, joined to it
/// by a line of sight.
///
/// A value, owned by the mission (inside FrontierPlanner). Deterministic. Thread-safety: none.
/// Never throws after construction. Cost: linear in the cells counted; memory: that of the map's
/// frame. Source: our choice.
class FrontierUtility {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit FrontierUtility(const FrontierUtilityOptions& options);

  /// Renews the confidence near a change: `newly_known` cells that were unknown, `changed` all
  /// whose state changed; both in `frame`, to which the memory is brought (it may grow, not
  /// shrink).
  void map_changed(const GridFrame& frame, const std::vector<Cell>& newly_known,
                   const std::vector<Cell>& changed, const PausePoint& pause = {});

  /// What was measured has moved in W (correction.h): the memory goes with it.
  void follow(const PlaceMoves& moves);

  /// Counts a look at time `stamp` [s] from `pose` at the frontier cells in view, which are unknown
  /// by definition. see_through: nonzero where sight passes a cell. seen_from_here: a cell to which
  /// a line of sight leads from this place, by whatever line viewpoints are found.
  void observation(const Grid<std::uint8_t>& see_through, const std::vector<Frontier>& frontiers,
                   const Pose& pose, double stamp,
                   std::optional<Cell> seen_from_here = std::nullopt, const PausePoint& pause = {});

  /// A visit failed: those of `cells` within visit_radius of `target` [m, cells of that size].
  void visit_failed(Cell target, const std::vector<Cell>& cells, double resolution);

  /// A target of that promise A and E / y = `expected`, both [m^2] when it was chosen, has shown
  /// that much. Without effect where nothing was expected.
  void learn(double expected_gain, double expected, double shown);

  /// y(A).
  double yield(double expected_gain) const { return yields_[size_class(expected_gain)]; }

  /// tau_c.
  double confidence(Cell c) const { return static_cast<double>(confidence_.get(c, 1.0F)); }

  /// From how near each of its cells must be looked at [m], as ViewRanges; 0 for those that are not
  /// worth an observation while others of their cluster are: those with less than least_confidence
  /// of the greatest confidence in it.
  void view_ranges(const Frontier& frontier, std::vector<float>& ranges) const;

  /// Sets Frontier::promise to A_f, trust to the mean of tau, area to E_f, and given_up; 0, 1, 0
  /// and false for those that are not active.
  void measure(const Traversability& traversability, std::vector<Frontier>& frontiers,
               const PausePoint& pause = {});

 private:
  static std::size_t size_class(double expected_gain);
  int count(const Traversability& traversability, const Frontier& frontier,
            const PausePoint& pause);

  FrontierUtilityOptions options_;
  Grid<float> confidence_;
  Grid<float> range_;            // within which an observation may still show the cell [m]
  Grid<std::uint8_t> given_up_;  // 1: near a target of a visit that failed
  Grid<std::uint8_t> flips_;     // times that a change of known cells renewed it
  std::array<double, 5> yields_{0.5, 0.5, 0.5, 1.0, 1.0};  // by size_class()
  std::optional<double> last_observation_;
  Grid<std::uint8_t> visited_;  // about one frontier, while counting
  std::vector<Cell> queue_;
};

}  // namespace prospect
