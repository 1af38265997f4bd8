#include "engine/frontiers/goal_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/behaviour/formatted.h"
#include "engine/maps/held_up.h"
#include "engine/support/stopwatch.h"

namespace prospect {
namespace {

constexpr double kLooksFrom = 0.6;  // [m] before the first unknown cell; beyond the goal
constexpr double kLeaves = 2.0;     // times the tolerances, beyond which it is there no more

TraversabilityOptions with_unknown(TraversabilityOptions options, double price) {
  options.unknown_travel = price;
  return options;
}

CostToGoOptions unweighted(CostToGoOptions options) {
  options.lambda = 0.0;
  return options;
}

}  // namespace

GoalPlanner::GoalPlanner(const GoalPlannerOptions& options, const Goal& goal, double unknown_price)
    : options_(options),
      goal_(goal),
      traversability_(with_unknown(options.traversability, unknown_price)),
      field_(unweighted(options.cost_to_go)) {}

void GoalPlanner::solve(Cell robot) {
  const GridFrame& frame = traversability_.frame();
  const double reach = std::max(goal_.position_tolerance, 0.75 * frame.resolution);
  const GoalSources sources(frame, goal_.position, reach, traversability_.options().unknown_travel);
  if (frame == solved_) {
    field_.update(traversability_, sources, robot);
  } else {
    field_.solve_from_scratch(traversability_, sources, robot);
    solved_ = frame;
  }
}

// Down the field, over the lowest of the eight neighbours.
GoalPlanner::Way GoalPlanner::way() const {
  Way way;
  const double r = traversability_.frame().resolution;
  Cell c = field_.anchor();
  while (true) {
    const bool unknown = traversability_.state(c) == CellState::kUnknown;
    if (unknown && way.first_unknown < 0) way.first_unknown = static_cast<int>(way.cells.size());
    way.cells.push_back(c);
    const Cell next = field_.downhill(c);
    if (next == c) return way;
    const double step = r * std::hypot(next.i - c.i, next.j - c.j);
    way.length += step;
    if (unknown) way.unknown += step;
    c = next;
  }
}

// The first unknown cell; on a known way the narrowest cell ahead.
void GoalPlanner::close_on(const Way& way) {
  const GridFrame& frame = traversability_.frame();
  Cell at = way.cells.back();
  if (way.first_unknown >= 0) {
    at = way.cells[static_cast<std::size_t>(way.first_unknown)];
  } else {
    double least = std::numeric_limits<double>::infinity();
    const Eigen::Vector2d from = frame.center(way.cells.front());
    for (const Cell c : way.cells) {
      const double distance = (frame.center(c) - from).norm();
      if (distance > kHeldUpWithin) break;
      if (distance < kHeldUpRadius || traversability_.clearance(c) >= least) continue;
      least = traversability_.clearance(c);
      at = c;
    }
  }
  traversability_.close(at, kHeldUpRadius);
  ++closed_;
  monitor_.restart();
}

std::string GoalPlanner::why_unreachable(int closed) const {
  const TraversabilityOptions& t = options_.traversability;
  const Cell c = traversability_.frame().cell(goal_.position.x(), goal_.position.y());
  const double room = t.hard_radius;
  if (t.zones != nullptr) {
    for (int part = 0; part < t.zones->num_forbidden(); ++part) {
      const double distance = t.zones->distance(part, goal_.position);
      if (distance >= room - t.lattice_slack) continue;
      const bool bound = t.zones->zones().bound && part == 0;
      if (distance <= 0.0)
        return bound ? "it is beyond the bound" : "it is in " + t.zones->name(part);
      return formatted("it is %.2f m from %s, and the robot needs %.2f m", distance,
                       t.zones->name(part).c_str(), room);
    }
  }
  if (traversability_.state(c) == CellState::kOccupied)
    return "it is in a wall or another obstacle";
  if (!traversability_.clear(c)) {
    return formatted("it is %.2f m from an obstacle, and the robot needs %.2f m",
                     traversability_.clearance(c), room);
  }
  if (closed > 0) {
    return formatted("%d %s there could not be passed or seen, and no other is left", closed,
                     closed == 1 ? "way" : "ways");
  }
  return "what is known of walls and forbidden areas closes every way there";
}

std::shared_ptr<const GlobalPlan> GoalPlanner::update(
    const GroundMap& ground, const Pose& pose, double stamp, bool pursued,
    const std::optional<Eigen::Vector2d>& blocked) {
  Stopwatch watch;
  if (!traversability_.continues(ground)) {
    traversability_ = Traversability(traversability_.options());
    solved_ = {};
  }
  traversability_.update(ground);
  const GridFrame& frame = traversability_.frame();
  const Eigen::Vector2d p = pose.position.head<2>();
  const Cell robot = frame.cell(p.x(), p.y());
  if (blocked) {
    const std::optional<Cell> at = held_up_at(frame, p, *blocked);
    if (at) traversability_.close(*at, kHeldUpRadius);
  }
  solve(robot);
  const double explored = traversability_.explored_area();

  const double share = facts_.reached ? kLeaves : 1.0;
  facts_.distance = (p - goal_.position).norm();
  const double turned =
      goal_.yaw ? std::abs(std::remainder(pose.yaw - *goal_.yaw, 2.0 * M_PI)) : 0.0;
  facts_.reached =
      facts_.distance <= share * goal_.position_tolerance && turned <= share * goal_.yaw_tolerance;

  Way found;
  const auto look = [&] {
    found = field_.anchor_reached() ? way() : Way{};
    const GridFrame& f = traversability_.frame();
    // From the rim of the map on as the crow flies.
    const double beyond =
        found.cells.empty() ? 0.0 : (f.center(found.cells.back()) - goal_.position).norm();
    facts_.way_left = found.length + beyond;
    facts_.unknown_left =
        found.unknown + (beyond > goal_.position_tolerance + f.resolution ? beyond : 0.0);
  };
  look();
  if (!found.cells.empty()) {
    // At the place it turns, which brings it no nearer.
    const bool there = facts_.distance <= goal_.position_tolerance;
    monitor_.update(stamp, p, facts_.way_left, explored, pursued && !facts_.reached && !there);
    if (monitor_.hopeless()) {
      close_on(found);
      solve(robot);
      look();
      if (!found.cells.empty()) monitor_.update(stamp, p, facts_.way_left, explored, pursued);
    }
  }
  facts_.stalled = !found.cells.empty() && monitor_.stalled();
  facts_.stalled_for = found.cells.empty() ? 0.0 : monitor_.stalled_for();
  facts_.unreachable = found.cells.empty() && !facts_.reached && explored > 0.0;
  if (!facts_.unreachable) {
    unreachable_since_.reset();
  } else if (!unreachable_since_ || stamp < *unreachable_since_) {
    unreachable_since_ = stamp;
  }
  facts_.unreachable_for = unreachable_since_ ? stamp - *unreachable_since_ : 0.0;
  facts_.why = facts_.unreachable ? why_unreachable(closed_) : "";
  facts_.near = !found.cells.empty() && facts_.unknown_left == 0.0 && facts_.way_left <= kNear;

  auto global_plan = std::make_shared<GlobalPlan>();
  global_plan->map_revision = ground.revision();
  global_plan->stamp = stamp;
  global_plan->cost_to_go = field_.window();
  global_plan->explored_area = explored;
  if (!found.cells.empty()) {
    FrontierTarget target;
    target.viewpoint = goal_.position;
    const double heading = goal_.yaw.value_or(pose.yaw);
    target.looks_at =
        goal_.position + kLooksFrom * Eigen::Vector2d(std::cos(heading), std::sin(heading));
    target.yaw = heading;
    if (found.first_unknown >= 0) {
      const auto first = static_cast<std::size_t>(found.first_unknown);
      const Eigen::Vector2d seen = frame.center(found.cells[first]);
      Frontier ahead;
      for (std::size_t n = first; n < found.cells.size(); ++n) {
        if ((frame.center(found.cells[n]) - seen).norm() > kLookAhead) break;
        if (traversability_.state(found.cells[n]) != CellState::kUnknown) continue;
        ahead.cells.push_back(found.cells[n]);
        ahead.centroid += frame.center(found.cells[n]);
      }
      ahead.centroid /= static_cast<double>(ahead.cells.size());
      ahead.length = static_cast<double>(ahead.cells.size()) * frame.resolution;
      ahead.viewpoints = 1;
      ahead.active = true;
      std::sort(ahead.cells.begin(), ahead.cells.end(), scan_less);
      global_plan->frontiers.push_back(std::move(ahead));
      target.frontier = 0;
      target.looks_at = seen;
      target.viewpoint = p;
      for (std::size_t n = 0; n < first; ++n) {
        const Eigen::Vector2d at = frame.center(found.cells[n]);
        if ((at - seen).norm() < kLooksFrom) break;
        target.viewpoint = at;
      }
      const Eigen::Vector2d to = target.looks_at - target.viewpoint;
      target.yaw = std::atan2(to.y(), to.x());
    }
    global_plan->target = target;
    global_plan->facts.target = true;
    global_plan->facts.way_left = facts_.way_left;
    if (target.frontier == 0) global_plan->facts.target_length = global_plan->frontiers[0].length;
  }
  global_plan->milliseconds = watch.lap();
  return global_plan;
}

}  // namespace prospect
