#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "engine/behaviour/monitors/progress_monitor.h"
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
  ProgressMonitor::Options progress;  ///< a hopeless target is suppressed
  int retries = 2;                    ///< times that everything is reactivated before "done"
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
/// * A target towards which the robot makes no progress (ProgressMonitor) and that is hopeless: all
///   its cells are suppressed.
/// * Before nothing is left everything is reactivated (forgive()), `retries` times; retry_area
/// explored
///   restores the retries, twice that the next time and so on: a map that noise widens for ever
///   would give retries for ever.
///
/// Deterministic. Thread-safety: none (one mission, one thread). Never throws after construction.
/// Source: formulation, section 6; the prototype's constants.
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
  void hold_clock(double stamp) { progress_.hold(stamp); }

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

  enum class Verdict {
    kPursue,      ///< the target stands
    kAskAgain,    ///< cells were suppressed or reactivated: the cost-to-go must be computed again,
                  ///< then judge() called with the result
    kNothingLeft  ///< no active frontier is reachable, after all retries
  };
  /// After the cost-to-go is known. target: frontier index and cell it leads the robot to, if any
  /// frontier is reachable; position of the robot in W [m]; value [m]: cost-to-go there without the
  /// head start; explored [m^2].
  Verdict judge(const std::vector<Frontier>& frontiers, const GridFrame& frame,
                std::optional<std::pair<int, Cell>> target, const Eigen::Vector2d& position,
                double value, double explored, double stamp);

  int retries_used() const { return retries_used_; }
  /// [m^2] newly explored that restores the retries next.
  double retry_area() const { return retry_area_; }
  /// At the last judge().
  const ProgressMonitor& progress() const { return progress_; }
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
  ProgressMonitor progress_;
  std::optional<double> retry_explored_;
  double retry_area_ = 0.0;
  int retries_used_ = 0;
  std::vector<Eigen::Vector2d> losses_;  // where the losses were that gave a retry back
  int given_up_ = 0;
};

}  // namespace prospect
