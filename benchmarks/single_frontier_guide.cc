#include "benchmarks/single_frontier_guide.h"

#include <chrono>
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

}  // namespace

SingleFrontierGuide::SingleFrontierGuide(FrontierRule rule, const ExplorationGuideOptions& options,
                                         double reselect_after)
    : rule_(rule),
      reselect_after_(reselect_after),
      traversability_(options.traversability),
      detector_(options.frontiers),
      memory_(options.memory),
      field_(options.cost_to_go) {
  auto empty = std::make_shared<Guidance>();
  empty->cost_to_go = std::make_shared<const CostToGo>();
  last_ = std::move(empty);
}

// Dijkstra over 8 neighbours; a diagonal step needs both cells beside it, so that what is reached
// is what the cost-to-go reaches.
void SingleFrontierGuide::flood(Cell robot) {
  const GridFrame& frame = traversability_.frame();
  distance_.assign(static_cast<std::size_t>(frame.size()), kInfinity);
  const Cell start = passable_near(traversability_, robot);
  if (!traversability_.passable(start)) return;
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
        if ((di == 0 && dj == 0) || !traversability_.passable(n)) continue;
        const bool diagonal = di != 0 && dj != 0;
        if (diagonal &&
            (!traversability_.passable({n.i, c.j}) || !traversability_.passable({c.i, n.j}))) {
          continue;
        }
        const double length = frame.resolution * (diagonal ? std::numbers::sqrt2 : 1.0);
        reach(n, value + length * static_cast<double>(traversability_.factor(n)));
      }
    }
  }
}

void SingleFrontierGuide::find_options(Cell robot) {
  options_.clear();
  flood(robot);
  const GridFrame& frame = traversability_.frame();
  const std::vector<Frontier>& frontiers = detector_.frontiers();
  // A cell keeps only its best source, so each frontier's viewpoints are listed by admitting that
  // frontier alone, in a copy: the field must see the changes of its own detector.
  FrontierDetector alone = detector_;
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

int SingleFrontierGuide::choose(Cell robot, double stamp) {
  const std::vector<Frontier>& frontiers = detector_.frontiers();
  const int current = memory_.current_target(frontiers, traversability_.frame());
  const bool due =
      rule_ == FrontierRule::kCostUtility && stamp - chosen_at_ >= reselect_after_ - 1e-9;
  if (current >= 0 && frontiers[static_cast<std::size_t>(current)].active && !due) return current;
  ++choices_;
  chosen_at_ = stamp;
  find_options(robot);
  return choose_frontier(rule_, options_);
}

std::shared_ptr<const Guidance> SingleFrontierGuide::update(const GroundMap& ground,
                                                            const Pose& pose, double stamp) {
  const auto begin = std::chrono::steady_clock::now();
  constexpr double kFarthest = 1e6;  // beyond this the cell address would not fit an int
  const Eigen::Vector2d p = pose.position.head<2>();
  if (!p.allFinite() || !(p.cwiseAbs().maxCoeff() < kFarthest) || !std::isfinite(pose.yaw) ||
      !std::isfinite(stamp)) {
    return last_;
  }
  traversability_.update(ground);
  detector_.update(traversability_);
  memory_.map_changed(traversability_.changed_states());
  memory_.look(traversability_.states(), detector_.frontiers(), pose, stamp);

  const GridFrame& frame = traversability_.frame();
  const Cell robot = frame.cell(p.x(), p.y());
  auto guidance = std::make_shared<Guidance>();
  for (bool again = true; again;) {
    memory_.suppression(frame, suppressed_);
    detector_.find_viewpoints(traversability_, suppressed_);
    const std::vector<Frontier>& frontiers = detector_.frontiers();
    const auto lead_to = [&](int frontier) {
      std::vector<double> bonus(frontiers.size(), -kInfinity);
      if (frontier >= 0) bonus[static_cast<std::size_t>(frontier)] = 0.0;
      detector_.set_bonuses(bonus);
      field_.update(traversability_, detector_, robot);
    };
    const int choices = choices_;
    int chosen = choose(robot, stamp);
    lead_to(chosen);
    if (!field_.anchor_reached() && choices_ == choices) {
      // The frontier held so far cannot be reached any more.
      ++choices_;
      chosen_at_ = stamp;
      find_options(robot);
      chosen = choose_frontier(rule_, options_);
      lead_to(chosen);
    }

    guidance->target.reset();
    std::optional<std::pair<int, Cell>> target;
    double value = 0.0;
    if (field_.anchor_reached()) {
      const ViewpointSource source = detector_.source_at(field_.source_of_anchor());
      if (source.frontier >= 0) {
        target = {source.frontier, source.sees};
        value = field_.value(field_.anchor());
        const Eigen::Vector2d from = frame.center(source.cell);
        const Eigen::Vector2d to = frame.center(source.sees);
        guidance->target = FrontierTarget{source.frontier, from, to,
                                          std::atan2(to.y() - from.y(), to.x() - from.x())};
      }
    }
    const double explored = traversability_.explored_area();
    if (explored == 0.0) {
      guidance->advice = Advice::kPlan;  // nothing seen yet is not everything seen
      again = false;
    } else {
      guidance->advice = memory_.decide(frontiers, frame, target, value, explored, stamp, &again);
    }
  }

  guidance->map_revision = ground.revision();
  guidance->stamp = stamp;
  guidance->frontiers = detector_.frontiers();
  if (guidance->target) {
    guidance->frontiers[static_cast<std::size_t>(guidance->target->frontier)].reachable = true;
  }
  guidance->cost_to_go = field_.window();
  guidance->explored_area = traversability_.explored_area();
  guidance->stalled_for = memory_.stalled_for();
  guidance->retries_used = memory_.retries_used();
  guidance->suppressed_cells = memory_.suppressed_count();
  guidance->milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  last_ = guidance;
  return guidance;
}

}  // namespace prospect
