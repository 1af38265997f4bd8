#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "engine/behaviour/facts.h"
#include "engine/behaviour/monitors/exhaustion_monitor.h"
#include "engine/behaviour/monitors/low_yield_monitor.h"
#include "engine/cost_to_go.h"
#include "engine/cost_to_go_field.h"
#include "engine/feature_outlook.h"
#include "engine/frontier_area.h"
#include "engine/frontier_memory.h"
#include "engine/frontiers.h"
#include "engine/ground_map.h"
#include "engine/polygon.h"
#include "engine/traversability.h"
#include "models/types.h"

namespace prospect {

struct ExplorationGuideOptions {
  TraversabilityOptions traversability;
  FrontierOptions frontiers;
  FrontierMemoryOptions memory;
  CostToGoOptions cost_to_go;
  /// Added to lattice_slack where narrow passages are searched [m]; see ExplorationGuide.
  double relaxed_slack = 0.1;
  /// Smallest frontier where short ones are searched [m], if less than frontiers.min_length.
  double relaxed_length = 0.2;
  /// How often the narrow passages at which targets were given up are opened again.
  int reopenings = 1;
  LowYieldMonitor::Options low_yield;
  std::optional<Polygon> area{};  ///< only frontiers in here are led to; none: all
  double look_length = 2.0;       ///< [m] of travel that a look at a frontier counts as; see below
  double kappa = 0.5;             ///< [m] bonus of a frontier per unit of log(1 + length in m)
  double kappa_area = 0.0;  ///< [m] likewise of log(1 + area in m^2), where there is ample room
  double area_depth = 1.0;  ///< [m] how far behind a frontier its area counts
  double ample_room = 0.1;  ///< [m] by how much more than hard_radius a way must be clear
};

/// What the robot did since the last update.
struct GuideAttention {
  bool looked = true;     ///< images extended the map: what was in view was looked at
  bool pursued = true;    ///< it tried to reach the target; false: it had something else to do
  bool got_lost = false;  ///< localization was lost on the way: the target is put off
  /// Direction in W in which the robot does not get on, though the map says so: a disc there is
  /// impassable from now on, until another search begins.
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
  FrontierFacts facts;                         ///< what the behaviour is decided by
  double explored_area = 0.0;                  ///< [m^2]
  int retries_used = 0;
  int suppressed_cells = 0;
  double milliseconds = 0.0;  ///< wall time of the update: a report, not an input to anything
};

/// Frontiers, their hygiene and the cost-to-go, from one planning step to the next:
///
///   ExplorationGuide guide(options);
///   std::shared_ptr<const Guidance> g = guide.update(*belief.ground, belief.pose, belief.stamp);
///   problem term: CostToGoTerm(g->cost_to_go);   g->facts: what is decided by (behaviour.h)
///
/// V(p) = min_c [D(p, c) - kappa log(1 + l_c) - kappa_area log(1 + A_c)] / v_max [s], l_c the
/// length of frontier c [m] and A_c the area that it promises [m^2] (frontier_area.h); with the
/// current target's head start. A_c counts as 0 where no way with ample room leads: by cells that
/// have ample_room more than the hard constraint asks for (at most comfortable_radius in all), from
/// the nearest such cell to the robot. Else the robot would turn into the gaps of a narrow building
/// with half of its corridor unseen, and a robot that errs by centimetres touches something there.
/// Nor do areas count where short frontiers or narrow passages are searched: what is left then is
/// slivers, and what a drifting estimate drew. Another rule for the bonus may be given. With an
/// outlook, a metre travelled costs 1 + lambda max(0, 1 - N / N_req) times as much, N the features
/// in view in the direction of travel (down the field of the step before), and a viewpoint lambda
/// look_length max(0, 1 - N / N_req) more, N in the direction of what is looked at.
///
/// When nothing is reachable, it asks on in the same update as the table of searches says
/// (search.h):
///   short frontiers: those count from relaxed_length on.
///   narrow passages: those count as passable that are up to twice relaxed_slack narrower than the
///      hard constraint asks for, and what was given up is tried again: a look from near opens
///      doors that a drifting estimate has closed. What may be driven is decided by the
///      certificate, not here: a passage at which a target is given up is closed, else every
///      frontier behind it would be tried in turn; before nothing is left all are opened again,
///      and everything is tried again, `reopenings` times.
/// It goes back to ordinary ones once retry_area was newly explored, twice that the next time.
///
/// An estimate that drifts can draw the robot in: then nothing is reachable, but it is not
/// everything explored. So the guide keeps the places where the robot has been, and facts.cut_off
/// says whether most of those that are passable are not joined any more to where it is.
///
/// A robot that is lost does not extend its map, and one that retreats does not drive to its
/// target: the attention says so, else frontiers are given up that nobody has tried.
///
/// A value. Thread-safety: none (one mission, one thread); what update() returns is immutable and
/// may be shared. update() never throws on a finite pose; a non-finite pose gives the last guidance
/// again. Source: formulation, section 6.
class ExplorationGuide {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit ExplorationGuide(const ExplorationGuideOptions& options);

  /// ground: any map; after one of another place or resolution (Traversability::continues()) the
  /// guide begins anew. stamp [s], non-decreasing. attention: of the time since
  /// the last update. outlook: what is seen from where, null: no localization weighting. rule:
  /// null: the bonuses above.
  std::shared_ptr<const Guidance> update(const GroundMap& ground, const Pose& pose, double stamp,
                                         const GuideAttention& attention = {},
                                         const FeatureOutlook* outlook = nullptr,
                                         const BonusRule& rule = nullptr);

  /// Whether what lies at p, in W, is to be seen: within the area, if there is one, and in no
  /// forbidden part of traversability.zones.
  bool counts(const Eigen::Vector2d& p) const;

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
  void restart(Search search);
  void count_along_travel(const FeatureOutlook& outlook);
  void close_passage();
  void leave_out_what_does_not_count();
  void flood(Cell start, double room = 0.0);
  Cell nearest_with(double room, Cell start);
  void mark_reachable(std::vector<Frontier>& frontiers);
  bool is_cut_off();
  Cell downhill(Cell c) const;
  double way_left() const;

  ExplorationGuideOptions options_;
  Traversability traversability_;
  FrontierDetector detector_;
  FrontierMemory memory_;
  FrontierArea area_;
  CostToGoField field_;
  LowYieldMonitor low_yield_;
  ExhaustionMonitor exhaustion_;
  Grid<std::uint8_t> suppressed_;
  Grid<float> along_travel_;             // features seen in the direction of travel, by cell
  std::vector<std::uint8_t> component_;  // 1: of the last flood; by cell
  std::vector<int> stack_;
  std::vector<Eigen::Vector2d> been_;  // where the robot was while it was not lost, in W [m]
  Search search_ = Search::kOrdinary;
  bool restarted_ = false;          // every known cell will seem new
  double ordinary_explored_ = 0.0;  // [m^2] when ordinary frontiers were left
  bool passage_closed_ = false;     // since the last restart
  int reopenings_ = 0;              // since ordinary frontiers were left
  double new_ground_ = 0.0;         // [m^2] newly explored that leads back to them
  std::shared_ptr<const Guidance> last_;
};

}  // namespace prospect
