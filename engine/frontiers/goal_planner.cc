// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/goal_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/maps/held_up.h"
#include "engine/support/stopwatch.h"
#include "models/formatted.h"

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

void judge_arrival(const Goal& goal, const Pose& pose, bool any_heading, GoalFacts& facts) {
  const double share = facts.reached ? kLeaves : 1.0;
  const double turned = goal.yaw ? std::abs(std::remainder(pose.yaw - *goal.yaw, 2.0 * M_PI)) : 0.0;
  facts.distance = (pose.position.head<2>() - goal.position).norm();
  facts.reached = facts.distance <= share * goal.position_tolerance &&
                  (any_heading || turned <= share * goal.yaw_tolerance);
}

GoalPlanner::GoalPlanner(const GoalPlannerOptions& options, const Goal& goal, double unknown_price)
    : options_(options),
      goal_(goal),
      traversability_(with_unknown(options.traversability, unknown_price)),
      field_(unweighted(options.cost_to_go)) {}

GoalPlanner::GoalPlanner(const GoalPlannerOptions& options, const Polygon& area,
                         double unknown_price)
    : GoalPlanner(options, Goal{area.front(), std::nullopt}, unknown_price) {
  area_ = area;
}

void GoalPlanner::follow(const std::shared_ptr<const ZoneMap>& zones, const Goal& goal,
                         const std::optional<Polygon>& area) {
  options_.traversability.zones = zones;
  traversability_.set_zones(zones);
  solved_ = GridFrame();
  if (!area_) {
    goal_ = goal;
  } else if (area) {
    area_ = area;
    goal_.position = area->front();
  }
}

void GoalPlanner::follow(const PlaceMoves& moves) {
  monitor_.follow([&](const Eigen::Vector2d& p) { return moves.now(p); });
}

void GoalPlanner::solve(Cell robot, const PausePoint& pause) {
  const GridFrame& frame = traversability_.frame();
  if (area_) {
    sources_.emplace(traversability_, *area_, pause);
    field_.solve_from_scratch(traversability_, *sources_, robot, pause);
    return;
  }
  const double reach = std::max(goal_.position_tolerance, 0.75 * frame.resolution);
  const GoalSources sources(frame, goal_.position, reach, traversability_.options().unknown_travel);
  if (frame == solved_) {
    field_.update(traversability_, sources, robot, pause);
  } else {
    field_.solve_from_scratch(traversability_, sources, robot, pause);
    solved_ = frame;
  }
}

// Down the field, over the lowest of the eight neighbours.
GoalPlanner::Path GoalPlanner::path() const {
  Path path;
  const double r = traversability_.frame().resolution;
  Cell c = field_.anchor();
  while (true) {
    const bool unknown = traversability_.state(c) == CellState::kUnknown;
    if (unknown && path.first_unknown < 0) path.first_unknown = static_cast<int>(path.cells.size());
    path.cells.push_back(c);
    const Cell next = field_.downhill(c);
    if (next == c) return path;
    const double step = r * std::hypot(next.i - c.i, next.j - c.j);
    path.length += step;
    if (unknown) path.unknown += step;
    c = next;
  }
}

// The first unknown cell; on a known path the narrowest cell ahead.
void GoalPlanner::close_on(const Path& path) {
  const GridFrame& frame = traversability_.frame();
  Cell at = path.cells.back();
  if (path.first_unknown >= 0) {
    at = path.cells[static_cast<std::size_t>(path.first_unknown)];
  } else {
    double least = std::numeric_limits<double>::infinity();
    const Eigen::Vector2d from = frame.center(path.cells.front());
    for (const Cell c : path.cells) {
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

// [m] from where the path ends to where it leads; more than a little only from the map's rim on.
double GoalPlanner::beyond_end(const Path& path) const {
  const Cell last = path.cells.back();
  const Eigen::Vector2d end = traversability_.frame().center(last);
  if (!area_) return (end - goal_.position).norm();
  return sources_->source(last) == 0.0F ? 0.0 : sources_->outside(end);
}

void GoalPlanner::update_reached(const Pose& pose, double stamp, const FrontierActivity& activity) {
  if (area_) return;
  facts_.distance = (pose.position.head<2>() - goal_.position).norm();
  const double turned =
      goal_.yaw ? std::abs(std::remainder(pose.yaw - *goal_.yaw, 2.0 * M_PI)) : 0.0;
  if (goal_.yaw) {
    const bool there = facts_.distance <= kLeaves * goal_.position_tolerance;
    heading_.update(stamp, there, turned, {activity.pursued, activity.got_lost});
  }
  const bool any_heading = heading_.verdict() != HeadingMonitor::Verdict::kOpen;
  judge_arrival(goal_, pose, any_heading, facts_);
  facts_.heading_missed.reset();
  if (any_heading && turned > goal_.yaw_tolerance) facts_.heading_missed = turned;
  facts_.heading_why = heading_.verdict() == HeadingMonitor::Verdict::kGetsLost
                           ? "it loses its localization when it turns to it"
                           : "it does not get round to it";
}

// What is wrong with the place itself; empty: nothing.
std::string GoalPlanner::why_not_there() const {
  const TraversabilityOptions& t = options_.traversability;
  const Eigen::Vector2d at = goal_.position;
  if (area_ ? sources_->beyond_extent() : t.extent && !t.extent->contains(at)) {
    return "it is outside of the world";
  }
  const double room = t.hard_radius;
  for (int part = 0; t.zones != nullptr && part < t.zones->num_forbidden(); ++part) {
    const double distance = t.zones->distance(part, at);
    const std::string name = t.zones->name(part);
    if (area_) {
      const auto in = [&](const Eigen::Vector2d& p) { return t.zones->distance(part, p) <= 0.0; };
      if (!sources_->nowhere() || std::none_of(area_->begin(), area_->end(), in)) continue;
      return "all of it is forbidden, by " + name;
    }
    if (distance >= room - t.lattice_slack) continue;
    if (distance > 0.0) {
      return formatted("it is %.2f m from %s, and the robot needs %.2f m", distance, name.c_str(),
                       room);
    }
    return (t.zones->zones().bound && part == 0 ? "it is beyond " : "it is in ") + name;
  }
  if (area_) return "";
  const Cell c = traversability_.frame().cell(at.x(), at.y());
  if (traversability_.state(c) == CellState::kOccupied) {
    return "it is in a wall or another obstacle";
  }
  if (traversability_.clear(c)) return "";
  return formatted("it is %.2f m from an obstacle, and the robot needs %.2f m",
                   traversability_.clearance(c), room);
}

std::string GoalPlanner::why_unreachable(const GroundMap& ground, const Pose& pose,
                                         const PausePoint& pause) const {
  if (const std::string why = why_not_there(); !why.empty()) return why;
  if (options_.traversability.zones != nullptr) {
    // Whether there would be a path without the zones, and into which it leads first.
    GoalPlannerOptions free = options_;
    free.traversability.zones = nullptr;
    const double price = traversability_.options().unknown_travel;
    GoalPlanner without =
        area_ ? GoalPlanner(free, *area_, price) : GoalPlanner(free, goal_, price);
    without.update(ground, pose, 0.0, {}, pause);
    if (!without.facts_.unreachable) {
      const ZoneMap& zones = *options_.traversability.zones;
      for (const Cell c : without.path().cells) {
        const Eigen::Vector2d center = traversability_.frame().center(c);
        for (int part = 0; part < zones.num_forbidden(); ++part) {
          if (zones.distance(part, center) < options_.traversability.hard_radius) {
            return zones.name(part) + " bars every way there";
          }
        }
      }
    }
  }
  if (closed_ > 0) {
    return formatted("%d %s there could not be passed or seen, and no other is left", closed_,
                     closed_ == 1 ? "way" : "ways");
  }
  return "what is known of walls closes every way there";
}

std::shared_ptr<const GlobalPlan> GoalPlanner::update(const GroundMap& ground, const Pose& pose,
                                                      double stamp,
                                                      const FrontierActivity& activity,
                                                      const PausePoint& pause) {
  Stopwatch watch;
  if (!traversability_.continues(ground, pause)) {
    traversability_ = Traversability(traversability_.options());
    solved_ = {};
  }
  traversability_.update(ground, nullptr, pause);
  const GridFrame& frame = traversability_.frame();
  const Eigen::Vector2d p = pose.position.head<2>();
  const Cell robot = frame.cell(p.x(), p.y());
  if (activity.blocked) {
    const std::optional<Cell> at = held_up_at(frame, p, *activity.blocked);
    if (at) traversability_.close(*at, kHeldUpRadius);
  }
  solve(robot, pause);
  const double explored = traversability_.explored_area();
  update_reached(pose, stamp, activity);

  Path found;
  const auto observation = [&] {
    found = field_.anchor_reached() ? path() : Path{};
    // From the rim of the map on as the crow flies.
    const double beyond = found.cells.empty() ? 0.0 : beyond_end(found);
    facts_.path_left = found.length + beyond;
    facts_.unknown_left =
        found.unknown + (beyond > goal_.position_tolerance + frame.resolution ? beyond : 0.0);
  };
  observation();
  if (!found.cells.empty()) {
    // At the place it turns, which brings it no nearer.
    const bool there = !area_ && facts_.distance <= goal_.position_tolerance;
    const auto update = [&](bool pursued) {
      monitor_.update(
          stamp, frame.center(field_.anchor()),
          [&](const Eigen::Vector2d& at) { return field_.value(frame.cell(at.x(), at.y())); },
          explored, pursued);
    };
    update(activity.pursued && !facts_.reached && !there);
    if (monitor_.hopeless()) {
      close_on(found);
      solve(robot, pause);
      observation();
      if (!found.cells.empty()) update(activity.pursued);
    }
  }
  facts_.stalled = !found.cells.empty() && monitor_.stalled();
  facts_.stalled_for = found.cells.empty() ? 0.0 : monitor_.stalled_for();
  facts_.unreachable = found.cells.empty() && !facts_.reached && explored > 0.0;
  if (!facts_.unreachable) {
    unreachable_since_.reset();
    facts_.why.clear();
  } else if (!unreachable_since_ || stamp < *unreachable_since_) {
    unreachable_since_ = stamp;
    facts_.why = why_unreachable(ground, pose, pause);
  }
  facts_.unreachable_for = unreachable_since_ ? stamp - *unreachable_since_ : 0.0;
  facts_.near =
      !area_ && !found.cells.empty() && facts_.unknown_left == 0.0 && facts_.path_left <= kNear;

  auto global_plan = std::make_shared<GlobalPlan>(plan_along(found, pose));
  global_plan->map_revision = ground.revision();
  global_plan->stamp = stamp;
  global_plan->cost_to_go = field_.window();
  global_plan->explored_area = explored;
  global_plan->milliseconds = watch.lap();
  return global_plan;
}

// Its frontier and target.
GlobalPlan GoalPlanner::plan_along(const Path& found, const Pose& pose) const {
  const GridFrame& frame = traversability_.frame();
  const Eigen::Vector2d p = pose.position.head<2>();
  GlobalPlan plan;
  if (!found.cells.empty()) {
    FrontierTarget target;
    target.viewpoint = area_ ? frame.center(found.cells.back()) : goal_.position;
    const bool any_heading = heading_.verdict() != HeadingMonitor::Verdict::kOpen;
    const double heading = any_heading ? pose.yaw : goal_.yaw.value_or(pose.yaw);
    target.looks_at =
        target.viewpoint + kLooksFrom * Eigen::Vector2d(std::cos(heading), std::sin(heading));
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
      plan.frontiers.push_back(std::move(ahead));
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
    plan.target = target;
    plan.facts.target = true;
    plan.facts.path_left = facts_.path_left;
    if (target.frontier == 0) plan.facts.target_length = plan.frontiers[0].length;
  }
  return plan;
}

}  // namespace prospect
