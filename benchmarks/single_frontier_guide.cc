#include "benchmarks/single_frontier_guide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

namespace prospect {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The passable cell nearest to the robot within 1 m, as in CostToGoField; the robot's own if none.
Cell passable_near(const Traversability& traversability, Cell robot) {
  const int reach = static_cast<int>(std::ceil(1.0 / traversability.frame().resolution));
  int least = reach * reach + 1;
  Cell best = robot;
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      const int distance = di * di + dj * dj;
      const Cell c{robot.i + di, robot.j + dj};
      if (distance >= least || !traversability.passable(c)) continue;
      least = distance;
      best = c;
    }
  }
  return best;
}

ExplorationGuideOptions without_head_start(ExplorationGuideOptions options) {
  options.memory.hysteresis = 0.0;
  return options;
}

}  // namespace

SingleFrontierGuide::SingleFrontierGuide(FrontierRule rule, const ExplorationGuideOptions& options,
                                         double reselect_after)
    : rule_(rule), reselect_after_(reselect_after), guide_(without_head_start(options)) {}

// Dijkstra over 8 neighbours; a diagonal step needs both cells beside it, so that what is reached
// is what the cost-to-go reaches.
void SingleFrontierGuide::flood(const Traversability& traversability, Cell robot) {
  const GridFrame& frame = traversability.frame();
  distance_.assign(static_cast<std::size_t>(frame.size()), kInfinity);
  const Cell start = passable_near(traversability, robot);
  if (!traversability.passable(start)) return;
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto reach = [&](Cell c, double value) {
    const int index = frame.index(c);
    double& d = distance_[static_cast<std::size_t>(index)];
    if (value >= d) return;
    d = value;
    queue.emplace(value, index);
  };
  reach(start, 0.0);
  while (!queue.empty()) {
    const auto [value, index] = queue.top();
    queue.pop();
    if (value > distance_[static_cast<std::size_t>(index)]) continue;
    const Cell c = frame.at(index);
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        const Cell n{c.i + di, c.j + dj};
        if ((di == 0 && dj == 0) || !traversability.passable(n)) continue;
        const bool diagonal = di != 0 && dj != 0;
        if (diagonal &&
            (!traversability.passable({n.i, c.j}) || !traversability.passable({c.i, n.j}))) {
          continue;
        }
        const double length = frame.resolution * (diagonal ? std::numbers::sqrt2 : 1.0);
        reach(n, value + length * static_cast<double>(traversability.factor(n)));
      }
    }
  }
}

void SingleFrontierGuide::find_options(const BonusQuestion& question) {
  options_.clear();
  flood(question.traversability, question.robot);
  const GridFrame& frame = question.traversability.frame();
  const std::vector<Frontier>& frontiers = question.detector.frontiers();
  // A cell keeps only its best source, so each frontier's viewpoints are listed by admitting that
  // frontier alone, in a copy: the guide must see the changes of its own detector.
  FrontierDetector alone = question.detector;
  std::vector<double> bonus(frontiers.size(), -kInfinity);
  alone.set_bonuses(bonus);
  for (std::size_t k = 0; k < frontiers.size(); ++k) {
    if (!frontiers[k].active) continue;
    bonus[k] = 0.0;
    alone.set_bonuses(bonus);
    bonus[k] = -kInfinity;
    double least = kInfinity;
    for (const Cell c : alone.changed_sources()) {
      // Cells of the frontier admitted before are sources no more: infinite.
      const double cost = static_cast<double>(alone.source(c));
      least = std::min(least, cost + distance_[static_cast<std::size_t>(frame.index(c))]);
    }
    if (least == kInfinity) continue;
    const double cells =
        static_cast<double>(frontiers[k].cells.size()) - frontiers[k].suppressed_cells;
    options_.push_back({static_cast<int>(k), least, cells * frame.resolution});
  }
}

std::vector<double> SingleFrontierGuide::bonuses(const BonusQuestion& question, double stamp) {
  const std::vector<Frontier>& frontiers = question.detector.frontiers();
  const int current = question.current;
  const bool active = current >= 0 && frontiers[static_cast<std::size_t>(current)].active;
  const bool due =
      rule_ == FrontierRule::kCostUtility && stamp - chosen_at_ >= reselect_after_ - 1e-9;
  // Unreached: the frontier held so far is given up; one just chosen is as good as any.
  const bool choose = question.unreached ? held_ : !active || due;
  held_ = !choose;
  if (choose) {
    ++choices_;
    chosen_at_ = stamp;
    find_options(question);
    chosen_ = choose_frontier(rule_, options_);
  } else if (!question.unreached) {
    chosen_ = current;
  }
  std::vector<double> bonus(frontiers.size(), -kInfinity);
  if (chosen_ >= 0) bonus[static_cast<std::size_t>(chosen_)] = 0.0;
  return bonus;
}

std::shared_ptr<const Guidance> SingleFrontierGuide::update(const GroundMap& ground,
                                                            const Pose& pose, double stamp,
                                                            const GuideAttention& attention) {
  return guide_.update(ground, pose, stamp, attention, nullptr,
                       [&](const BonusQuestion& question) { return bonuses(question, stamp); });
}

}  // namespace prospect
