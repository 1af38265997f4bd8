#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "engine/cost_to_go.h"
#include "engine/cost_to_go_field.h"
#include "engine/feature_outlook.h"
#include "engine/frontier_area.h"
#include "engine/frontier_memory.h"
#include "engine/frontiers.h"
#include "engine/ground_map.h"
#include "engine/leftovers_clock.h"
#include "engine/traversability.h"
#include "models/types.h"

namespace prospect {

struct ExplorationGuideOptions {
  TraversabilityOptions traversability;
  FrontierOptions frontiers;
  FrontierMemoryOptions memory;
  CostToGoOptions cost_to_go;
  /// Added to lattice_slack when nothing is reachable any more [m]; see ExplorationGuide.
  double relaxed_slack = 0.1;
  /// Smallest frontier then [m], if less than frontiers.min_length: a keyhole may show a room.
  double relaxed_length = 0.2;
  /// How often the gaps at which targets were given up are opened again before "done".
  int reopenings = 1;
  /// [s] that nothing must have been reachable before "done": time to look all around once.
  double look_around = 8.0;
  LeftoversClock::Options leftovers;
  double look_length = 2.0;  ///< [m] of travel that a look at a frontier counts as; see below
  double kappa = 0.5;        ///< [m] bonus of a frontier per unit of log(1 + length in m)
  double kappa_area = 0.0;   ///< [m] likewise of log(1 + area in m^2), where there is ample room
  double area_depth = 1.0;   ///< [m] how far behind a frontier its area counts
  double ample_room = 0.1;   ///< [m] by how much more than hard_radius a way must be clear
};

/// What the robot did since the last update.
struct GuideAttention {
  bool looked = true;     ///< images extended the map: what was in view was looked at
  bool pursued = true;    ///< it tried to reach the target; false: it had something else to do
  bool got_lost = false;  ///< localization was lost on the way: the target is put off
  /// Direction in W in which the robot does not get on, though the map says so: a disc there is
  /// impassable from now on, until the rules for gaps change.
  std::optional<Eigen::Vector2d> blocked{};
};

/// Where the cost-to-go leads the robot.
struct FrontierTarget {
  int frontier = -1;                                    ///< index in Guidance::frontiers
  Eigen::Vector2d viewpoint = Eigen::Vector2d::Zero();  ///< in W [m]
  Eigen::Vector2d looks_at =
      Eigen::Vector2d::Zero();  ///< a frontier cell seen from there, in W [m]
  double yaw = 0.0;             ///< heading there that faces it [rad]
};

/// What a BonusRule is asked. The references hold during the call.
struct BonusQuestion {
  const Traversability& traversability;
  const FrontierDetector& detector;  ///< viewpoints are found
  int current = -1;                  ///< index of the current target, -1 for none
  Cell robot;
  bool unreached = false;  ///< asked a second time: the first answer leads the robot nowhere
};

/// The bonus of each of detector.frontiers() [m], -infinity for one that must not be led to; the
/// head start of the current target comes on top. A second answer that differs replaces the first.
using BonusRule = std::function<std::vector<double>(const BonusQuestion&)>;

/// What one planning step needs to know about the frontiers; immutable.
struct Guidance {
  std::uint64_t map_revision = 0;
  double stamp = 0.0;                          ///< [s]
  std::vector<Frontier> frontiers;             ///< all clusters, active or not
  std::shared_ptr<const CostToGo> cost_to_go;  ///< never null
  std::optional<FrontierTarget> target;        ///< none: nothing is reachable
  Advice advice = Advice::kPlan;
  double explored_area = 0.0;  ///< [m^2]
  double stalled_for = 0.0;    ///< [s] without progress
  int retries_used = 0;
  int suppressed_cells = 0;
  bool relaxed = false;    ///< narrow gaps count as passable: nothing else is reachable
  bool abandoned = false;  ///< done although something is left: the time for it is up
  /// Done, but less is explored than seems: most places where the robot has been are passable, and
  /// not joined any more to where it is.
  bool enclosed = false;
  double milliseconds = 0.0;  ///< wall time of the update: a report, not an input to anything
};

/// Frontiers, their hygiene and the cost-to-go, from one planning step to the next:
///
///   ExplorationGuide guide(options);
///   std::shared_ptr<const Guidance> g = guide.update(*belief.ground, belief.pose, belief.stamp);
///   problem term: CostToGoTerm(g->cost_to_go);   g->advice == Advice::kDone ends the mission
///
/// V(p) = min_c [D(p, c) - kappa log(1 + l_c) - kappa_area log(1 + A_c)] / v_max [s], l_c the
/// length of frontier c [m] and A_c the area that it promises [m^2] (frontier_area.h); with the
/// current target's head start. A_c counts as 0 where no way with ample room leads: by cells that
/// have ample_room more than the hard constraint asks for (at most comfortable_radius in all), from
/// the nearest such cell to the robot. Else the robot would turn into the gaps of a narrow building
/// with half of its corridor unseen, and a robot that errs by centimetres touches something there.
/// Nor do areas count under the weaker rules below: what is left then is slivers, and what a
/// drifting estimate drew. Another rule for the bonus may be given. With an outlook, a metre
/// travelled costs 1 + lambda max(0, 1 - N / N_req) times as much, N the features in view in the
/// direction of travel (down the field of the step before), and a viewpoint lambda look_length
/// max(0, 1 - N / N_req) more, N in the direction of what is looked at.
///
/// Before it says done, the guide asks twice more, under weaker rules:
///   1. keyholes: frontiers count from relaxed_length on. What a keyhole shows is a short frontier,
///      whatever lies behind it.
///   2. gaps: those count as passable that are up to twice relaxed_slack narrower than the hard
///      constraint asks for, and what was given up is tried again: walls drawn twice by a drifting
///      estimate close real doors, and a look from near opens them. What may be driven is decided
///      by the certificate, not here: a gap at which a target is given up is closed, else every
///      frontier behind it would be tried in turn; before "done" all gaps are opened again, and
///      everything is tried again, `reopenings` times.
/// It goes back to the first rules once retry_area was newly explored, twice that the next time.
///
/// For all this there is a LeftoversClock, which begins when the strict rules lead nowhere; when it
/// is up, the guide says done (Guidance::abandoned).
///
/// It says done only when nothing has been reachable for look_around, and advises kLookAround till
/// then: a cell that noise fills in a narrow passage must not end a mission, and a turn on the spot
/// clears it.
///
/// An estimate that drifts can also draw the robot in: then nothing is reachable, but it is not
/// everything explored. So the guide keeps the places where the robot has been, and says enclosed
/// when it is done and cut off from most of them.
///
/// A robot that is lost does not extend its map, and one that recovers does not drive to its
/// target: the attention says so, else frontiers are given up that nobody has tried.
///
/// A value. Thread-safety: none (one mission, one thread); what update() returns is immutable and
/// may be shared. update() never throws on a finite pose; a non-finite pose gives the last guidance
/// again. Source: formulation, section 6.
class ExplorationGuide {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit ExplorationGuide(const ExplorationGuideOptions& options);

  /// ground: successive states of one map. stamp [s], non-decreasing. attention: of the time since
  /// the last update. outlook: what is seen from where, null: no localization weighting. rule:
  /// null: the bonuses above.
  std::shared_ptr<const Guidance> update(const GroundMap& ground, const Pose& pose, double stamp,
                                         const GuideAttention& attention = {},
                                         const FeatureOutlook* outlook = nullptr,
                                         const BonusRule& rule = nullptr);

  const Traversability& traversability() const { return traversability_; }
  const FrontierDetector& detector() const { return detector_; }
  const FrontierMemory& memory() const { return memory_; }
  const CostToGoField& field() const { return field_; }

 private:
  std::shared_ptr<Guidance> step(const GroundMap& ground, const Pose& pose, double stamp,
                                 const GuideAttention& attention, const FeatureOutlook* outlook,
                                 const BonusRule& rule);
  std::vector<double> size_bonuses(Cell robot);
  std::vector<double> bonuses(const BonusQuestion& question, const BonusRule& rule);
  enum class Rules { kStrict, kKeyholes, kGaps };  // each weaker than the one before
  void restart(Rules rules);
  void count_along_travel(const FeatureOutlook& outlook);
  void close_gap();
  void flood(Cell start, double room = 0.0);
  Cell nearest_with(double room, Cell start);
  void mark_reachable(std::vector<Frontier>& frontiers);
  bool is_enclosed();

  ExplorationGuideOptions options_;
  Traversability traversability_;
  FrontierDetector detector_;
  FrontierMemory memory_;
  FrontierArea area_;
  CostToGoField field_;
  LeftoversClock leftovers_;
  Grid<std::uint8_t> suppressed_;
  Grid<float> along_travel_;             // features seen in the direction of travel, by cell
  std::vector<std::uint8_t> component_;  // 1: of the last flood; by cell
  std::vector<int> stack_;
  std::vector<Eigen::Vector2d> been_;  // where the robot was while it was not lost, in W [m]
  Rules rules_ = Rules::kStrict;
  bool restarted_ = false;  // every known cell will seem new
  double relaxed_explored_ = 0.0;
  std::optional<double> nothing_since_;  // [s] no target, and no retry either
  double updated_at_ = 0.0;              // [s]
  bool gap_closed_ = false;              // since the last restart
  int reopenings_ = 0;                   // since the strict rules were left
  double relaxed_area_ = 0.0;            // [m^2] newly explored that restores the strict rules
  std::shared_ptr<const Guidance> last_;
};

}  // namespace prospect
