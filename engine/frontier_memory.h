#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "engine/frontiers.h"
#include "engine/grid.h"
#include "models/types.h"

namespace prospect {

struct FrontierMemoryOptions {
  double hysteresis = 0.8;     ///< [m] head start of the current target
  double target_radius = 1.0;  ///< [m] how far a target may move in a step and stay the same
  int failed_looks = 4;        ///< steps in view and unresolved that suppress a cell
  double look_interval = 0.4;  ///< [s] steps closer in time than this count as one look
  double sensor_range = 4.0;   ///< r_max [m]
  double range_margin = 0.3;   ///< a cell counts as in view within sensor_range - range_margin [m]
  double sensor_fov = 1.047;   ///< horizontal field of view [rad]
  double fov_margin = 0.05;    ///< left out at either side [rad]
  int reactivation_cells = 2;  ///< a change this near (Chebyshev) forgives a cell
  /// How often a change of known cells (free to occupied or back) may forgive a cell: noise flips
  /// cells for ever. What newly became known always does.
  int reactivations = 2;
  double script_after = 3.0;       ///< [s] without progress: go and face the target by script
  double deactivate_after = 8.0;   ///< [s] without progress: the target is suppressed
  double progress_distance = 0.2;  ///< [m] fall of the cost-to-go that counts as progress
  double progress_area = 0.1;      ///< [m^2] newly explored that counts as progress
  int retries = 2;                 ///< times that everything is reactivated before "done"
  /// [m^2] newly explored that restores the retries; twice as much each time they are restored.
  double retry_area = 1.0;
  /// Losses of localization that give a retry back, so that they do not use them up: a target put
  /// off was not seen to fail. Restored with the retries.
  int loss_retries = 50;
  /// How many of them within loss_radius [m] of one place: a robot that turns to the same looks
  /// from there loses its localization again, for ever.
  int loss_retries_here = 3;
  double loss_radius = 0.5;
};

/// What the mission is told to do about its frontiers.
enum class Advice {
  kPlan,        ///< go on planning
  kGoAndFace,   ///< no progress for script_after: drive to the target's viewpoint and face it by
                ///< script
  kLookAround,  ///< nothing is reachable just now: turn on the spot, the map may say otherwise then
  kDone         ///< no active reachable frontier is left, after all retries
};

/// What was learned about frontiers from one planning step to the next. Pure logic on cells; the
/// map, the frontiers and the clock are passed in. A value, owned by the mission (inside
/// ExplorationGuide).
///
/// * Failed looks: a frontier cell that was in view for `failed_looks` looks and is still unknown
///   is suppressed: it gives no viewpoint and has no part in the cost-to-go. A change of the map
///   within reactivation_cells forgives it: counter and suppression. A cell in view = within range
///   and field of view of the pose, joined to it by a line of sight.
/// * Hysteresis: the frontier that holds the cell nearest the last target, within target_radius,
///   has `hysteresis` metres of head start.
/// * Stall watchdog: progress is progress_area newly explored, or a fall of the cost-to-go at the
///   robot by progress_distance under its least value for this target while the robot has moved as
///   far: a cell that noise opens and closes moves the cost-to-go of a robot that stands. Without
///   any for script_after: kGoAndFace; for deactivate_after: all cells of the target are
///   suppressed.
/// * Before "done" everything is reactivated (forgive()), `retries` times; retry_area explored
///   restores the retries, twice that the next time and so on: a map that noise widens for ever
///   would give retries for ever.
///
/// Deterministic. Thread-safety: none (one mission, one thread). Never throws after construction.
/// Source: formulation, section 6; the prototype's constants; what counts as progress is our
/// choice.
class FrontierMemory {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit FrontierMemory(const FrontierMemoryOptions& options);

  /// Forgives cells near a change: `newly_known` cells that were unknown, `changed` all whose state
  /// changed.
  void map_changed(const std::vector<Cell>& newly_known, const std::vector<Cell>& changed);

  /// Counts a look at time `stamp` [s] from `pose`: every frontier cell in view, and still unknown
  /// by definition, has one failed look more. see_through: nonzero where sight passes a cell.
  void look(const Grid<std::uint8_t>& see_through, const std::vector<Frontier>& frontiers,
            const Pose& pose, double stamp);

  /// Forgets all failed looks and what was given up: everything is tried again.
  void forgive();

  /// The time since the last decide(), up to `stamp` [s], does not count as standing still: the
  /// robot had something else to do than to reach its target.
  void hold_clock(double stamp);

  /// Suppresses the cells about the target (target_radius): the way to it, or the look at it, cost
  /// the robot, which is at `position` in W [m], its localization. Others come first then; it is
  /// tried again when the map changes there or nothing else is left, up to loss_retries times more
  /// than other targets, loss_retries_here times from one place.
  void put_off_target(const std::vector<Frontier>& frontiers, const GridFrame& frame,
                      const Eigen::Vector2d& position);

  bool suppressed(Cell c) const;
  int suppressed_count() const { return suppressed_count_; }
  /// One entry a cell of `frame`, 1 where suppressed; reuses `out`.
  void suppression(const GridFrame& frame, Grid<std::uint8_t>& out) const;

  /// Index of the frontier that is the current target, -1 for none: it gets the head start.
  int current_target(const std::vector<Frontier>& frontiers, const GridFrame& frame) const;

  /// After the cost-to-go is known. target: frontier index and cell it leads the robot to, if any
  /// frontier is reachable; position of the robot in W [m]; value [m]: cost-to-go there without the
  /// head start; explored [m^2]. Returns what to do; if it has suppressed or reactivated cells,
  /// `sources_changed` is set and the cost-to-go must be computed again (then call again with the
  /// result).
  Advice decide(const std::vector<Frontier>& frontiers, const GridFrame& frame,
                std::optional<std::pair<int, Cell>> target, const Eigen::Vector2d& position,
                double value, double explored, double stamp, bool* sources_changed);

  int retries_used() const { return retries_used_; }
  /// [m^2] newly explored that restores the retries next.
  double retry_area() const { return retry_area_; }
  /// [s] since the last progress, at the last decide().
  double stalled_for() const { return stalled_for_; }
  /// Targets given up because no progress was made towards them, so far.
  int given_up() const { return given_up_; }
  std::optional<Cell> target_cell() const { return target_; }

 private:
  struct Look {
    int failed = 0;
    bool suppressed = false;
    int forgiven = 0;  // times that a change of known cells did
  };
  using Key = std::pair<int, int>;  // (j, i): scan order
  void suppress_about(Cell target, const std::vector<Cell>& cells, double resolution);

  FrontierMemoryOptions options_;
  std::map<Key, Look> looks_;
  int suppressed_count_ = 0;
  std::optional<double> last_look_;
  std::optional<Cell> target_;
  std::optional<double> progress_stamp_;
  double decided_at_ = 0.0;  // stamp of the last decide()
  Eigen::Vector2d progress_position_ = Eigen::Vector2d::Zero();
  double best_value_ = 0.0;
  double progress_explored_ = 0.0;
  double retry_explored_ = 0.0;
  double retry_area_ = 0.0;
  int retries_used_ = 0;
  std::vector<Eigen::Vector2d> losses_;  // where the losses were that gave a retry back
  double stalled_for_ = 0.0;
  int given_up_ = 0;
  bool scripting_ = false;  // kGoAndFace was advised for the present target
};

}  // namespace prospect
