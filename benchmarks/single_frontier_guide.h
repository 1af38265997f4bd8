#pragma once

#include <memory>
#include <vector>

#include "benchmarks/frontier_rule.h"
#include "engine/exploration_guide.h"

namespace prospect {

/// Guidance to one frontier at a time: ExplorationGuide with a bonus rule that admits the chosen
/// frontier alone, so that the cost-to-go leads to its viewpoints only. All else (frontiers,
/// viewpoints, memory of failed looks, progress, retries, narrow passages before nothing is left)
/// is the guide's.
///
/// A choice holds as long as that frontier is active and reachable; what is within target_radius of
/// the last target counts as the same frontier (FrontierMemory). kCostUtility also chooses anew
/// every `reselect_after` [s]. kappa and hysteresis of the options have no effect.
///
/// A value. Thread-safety: none. update() never throws on a finite pose; a non-finite pose gives
/// the last guidance again.
class SingleFrontierGuide {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  SingleFrontierGuide(FrontierRule rule, const ExplorationGuideOptions& options,
                      double reselect_after = 3.0);

  std::shared_ptr<const Guidance> update(const GroundMap& ground, const Pose& pose, double stamp,
                                         const GuideAttention& attention = {});

  /// What the rule was last asked.
  const std::vector<FrontierOption>& options() const { return options_; }
  /// How often the rule has been asked.
  int choices() const { return choices_; }

 private:
  std::vector<double> bonuses(const BonusQuestion& question, double stamp);
  void find_options(const BonusQuestion& question);
  void flood(const Traversability& traversability, Cell robot);

  FrontierRule rule_;
  double reselect_after_;
  ExplorationGuide guide_;
  std::vector<FrontierOption> options_;
  std::vector<double> distance_;  // [m of path equivalent] from the robot, by cell
  int chosen_ = -1;               // index of the frontier led to
  bool held_ = false;             // it was chosen in an earlier step
  double chosen_at_ = 0.0;        // [s]
  int choices_ = 0;
};

}  // namespace prospect
