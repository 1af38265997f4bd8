// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/frontier_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/frontiers/known_paths.h"
#include "engine/maps/held_up.h"
#include "engine/support/stopwatch.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPlaceSpacing = 0.5;  // [m] between the places where the robot has been
// Times the patience [-] beyond which the path between two candidates is not searched: it counts as
// that by way of the robot.
constexpr double kFarthestBetween = 1.0;
constexpr double kFirstSearch =
    0.75;                            // times the patience [-] to which paths are searched at first
constexpr double kLastSearch = 3.0;  // times the patience [-] from which on all are
// [m] along either axis, within which features count on a path: what is seen from farther away will
// have changed by then, and the cost must not grow with the map.
constexpr double kPricedWithin = 10.0;
// [m] of a way that is too short to tell in which direction it sets out.
constexpr double kThere = 0.5;

}  // namespace

FrontierPlanner::FrontierPlanner(const FrontierPlannerOptions& options)
    : options_(options),
      traversability_(options.traversability),
      detector_(options.frontiers),
      utility_(options.utility),
      field_(options.cost_to_go),
      progress_(options.progress) {
  FrontierPlannerOptions checked = options;
  KnobCheck check("frontier planner");
  describe(check, checked);
  describe_end(check, checked);
  check_not_negative("frontier planner", "turn_time", options.turn_time);
  if (options.area) {
    const std::string fault = polygon_fault(*options.area);
    if (!fault.empty()) throw std::invalid_argument("exploration frontier_planner: area: " + fault);
  }
  auto empty = std::make_shared<GlobalPlan>();
  empty->cost_to_go = std::make_shared<const CostToGo>();
  last_ = std::move(empty);
}

void FrontierPlanner::close(Cell at, double stamp) {
  traversability_.close(at, kHeldUpRadius);
  closings_.push_back({at, stamp + options_.closing_time});
}

// The robot travels down the field of the step before. Where that says nothing, nor do the counts.
void FrontierPlanner::count_along_travel(const FeatureVisibilityMap& visibility_map, Cell robot,
                                         const PausePoint& pause) {
  const GridFrame frame = frame_around(robot, kPricedWithin, traversability_.frame().resolution);
  along_travel_.frame = frame;
  along_travel_.data.assign(static_cast<std::size_t>(frame.size()),
                            std::numeric_limits<float>::infinity());
  for (int index = 0; index < frame.size(); ++index) {
    if (index % 256 == 0) pause();
    const Cell c = frame.at(index);
    const double here = field_.value(c);
    if (!(here < kInfinity)) continue;
    // Upwind, as the field was solved: towards the lower neighbour.
    const auto descent = [&](int di, int dj) {
      const double ahead = field_.value({c.i + di, c.j + dj});
      const double behind = field_.value({c.i - di, c.j - dj});
      if (!(std::min(ahead, behind) < here)) return 0.0;
      return ahead < behind ? here - ahead : behind - here;
    };
    const double x = descent(1, 0), y = descent(0, 1);
    if (x == 0.0 && y == 0.0) continue;
    along_travel_[c] = static_cast<float>(visibility_map.count(c, std::atan2(y, x)));
  }
}

// The first narrow place on the path down.
std::optional<Cell> FrontierPlanner::narrow_ahead() const {
  if (!field_.anchor_reached()) return std::nullopt;
  const Cell goal = field_.source_of_anchor();
  const int steps = static_cast<int>(kHeldUpWithin / traversability_.frame().resolution);
  Cell c = field_.anchor();
  for (int step = 0; step < steps; ++step) {
    if (traversability_.narrow(c)) return c;
    const Cell next = field_.downhill(c);
    if (c == goal || next == c) break;
    c = next;
  }
  return std::nullopt;
}

// [m] from the robot's cell down the field to where it ends; 0 where it is not reached.
double FrontierPlanner::path_left() const {
  if (!field_.anchor_reached()) return 0.0;
  const double r = traversability_.frame().resolution;
  const Cell goal = field_.source_of_anchor();
  Cell c = field_.anchor();
  double length = 0.0;
  while (!(c == goal)) {
    const Cell next = field_.downhill(c);
    if (next == c) break;
    length += r * std::hypot(next.i - c.i, next.j - c.j);
    c = next;
  }
  return length;
}

void FrontierPlanner::follow(const FrontierPlannerOptions& told) {
  options_.area = told.area;
  options_.traversability.zones = told.traversability.zones;
  traversability_.set_zones(told.traversability.zones);
}

void FrontierPlanner::follow(const PlaceMoves& moves) {
  moved_ = true;
  for (Eigen::Vector2d& place : been_) place = moves.now(place);
  const GridFrame frame = traversability_.frame();
  const auto now = [&](Cell c) {
    const Eigen::Vector2d p = moves.now(frame.center(c));
    return frame.cell(p.x(), p.y());
  };
  // Of a place that could not be passed nothing is known where it is now, but for how long.
  for (Closing& c : closings_) {
    traversability_.reopen(c.at, kHeldUpRadius);
    c.at = now(c.at);
    traversability_.close(c.at, kHeldUpRadius);
  }
  if (target_) target_ = now(*target_);
  progress_.follow([&](const Eigen::Vector2d& p) { return moves.now(p); });
  utility_.follow(moves);
}

bool FrontierPlanner::counts(const Eigen::Vector2d& p) const {
  const ZoneMap* zones = options_.traversability.zones.get();
  return (!options_.area || contains(*options_.area, p)) &&
         (zones == nullptr || zones->distance(p) > 0.0);
}

// Places that are impassable by now say nothing: a wall drawn twice covers some of any room.
bool FrontierPlanner::is_cut_off() const {
  const GridFrame& frame = traversability_.frame();
  int joined = 0, cut_off = 0;
  for (const Eigen::Vector2d& place : been_) {
    const Cell c = frame.cell(place.x(), place.y());
    if (!traversability_.fits(c)) continue;
    ++(path_lengths_.length(c) < kInfinity ? joined : cut_off);
  }
  return cut_off > joined;
}

// The frontier that holds the cell nearest the last target, within target_radius.
int FrontierPlanner::current_target(const std::vector<Frontier>& frontiers,
                                    const PausePoint& pause) const {
  if (!target_) return -1;
  const double r = traversability_.frame().resolution;
  int best = -1;
  double least = options_.target_radius + 1e-9;
  for (std::size_t k = 0; k < frontiers.size(); ++k) {
    pause();
    for (const Cell c : frontiers[k].cells) {
      const double d = r * std::hypot(c.i - target_->i, c.j - target_->j);
      if (d >= least) continue;
      least = d;
      best = static_cast<int>(k);
    }
  }
  return best;
}

void FrontierPlanner::fail_visit(const std::vector<Frontier>& frontiers, TargetChange why,
                                 const PausePoint& pause) {
  const int current = current_target(frontiers, pause);
  if (current >= 0) {
    utility_.visit_failed(*target_, frontiers[static_cast<std::size_t>(current)].cells,
                          traversability_.frame().resolution);
  }
  target_.reset();
  dropped_ = why;
}

TargetChange FrontierPlanner::reason_to_choose(const std::vector<Frontier>& frontiers, int current,
                                               double stamp) {
  if (!target_) {
    const bool soon = last_->facts.exhausted && stamp - chosen_at_ < 0.5 * options_.reconsider;
    return soon ? TargetChange::kNone : dropped_;
  }
  if (current < 0) return TargetChange::kSeen;
  const Frontier& f = frontiers[static_cast<std::size_t>(current)];
  if (f.area < std::max(options_.least_area, options_.resolved * target_area_)) {
    return TargetChange::kSeen;
  }
  return stamp - chosen_at_ >= options_.reconsider - 1e-9 ? TargetChange::kBetter
                                                          : TargetChange::kNone;
}

// The path to each frontier, turning included, and whether there is any. Searched farther each
// time, until what lies farther can be neither the present target nor among the leading candidates.
bool FrontierPlanner::measure_paths(const Pose& pose, const std::vector<Frontier>& frontiers,
                                    int current, bool all, const Prices& prices) {
  const GridFrame& frame = traversability_.frame();
  const double v_max = options_.cost_to_go.v_max;
  const double horizon = v_max * options_.order.patience;  // [m]
  path_lengths_.begin_at_robot(traversability_, frame.cell(pose.position.x(), pose.position.y()),
                               prices.pause);
  double limit = all || options_.rule ? kInfinity : kFirstSearch * horizon;
  while (true) {
    path_lengths_.extend(limit, prices.path, prices.pause);
    path_to_.assign(frontiers.size(), Path{});
    std::size_t visited = 0;
    detector_.visit_viewpoints([&](int k, Cell c, Cell sees, double cost) {
      if (++visited % 512 == 0) prices.pause();
      Path& best = path_to_[static_cast<std::size_t>(k)];
      double length = path_lengths_.length(c) + cost;
      if (length >= best.length) return;
      if (prices.observation) length += prices.observation(c, sees);
      if (length >= best.length) return;
      best = {length, length / v_max + options_.observation_time,
              (path_lengths_.unpriced(c) + cost) / v_max + options_.observation_time, c};
    });
    for (std::size_t k = 0; k < frontiers.size(); ++k) {
      if (k % 64 == 0) prices.pause();
      add_turn(pose, frontiers[k], path_to_[k]);
    }
    if (limit == kInfinity) return true;
    const bool missed = current >= 0 && path_to_[static_cast<std::size_t>(current)].length > limit;
    if (!missed && nothing_farther_leads(pose.position.head<2>(), frontiers, limit, prices.pause)) {
      return false;
    }
    limit = limit >= kLastSearch * horizon ? kInfinity : 4.0 * limit;
  }
}

void FrontierPlanner::add_turn(const Pose& pose, const Frontier& frontier, Path& path) const {
  if (!(path.length < kInfinity)) return;
  double heading = path_lengths_.departure(path.viewpoint);
  if (path_lengths_.length(path.viewpoint) < kThere) {
    const Eigen::Vector2d to = frontier.centroid - pose.position.head<2>();
    heading = std::atan2(to.y(), to.x());
  }
  const double turn = options_.turn_time * std::abs(std::remainder(heading - pose.yaw, 2.0 * M_PI));
  path.cost += turn;
  path.time += turn;
}

// Whether no frontier to which the path is longer than `limit` can be a leading candidate. No path
// to look at a cell is shorter than the straight line, less what looking from a metre off saves.
bool FrontierPlanner::nothing_farther_leads(const Eigen::Vector2d& robot,
                                            const std::vector<Frontier>& frontiers, double limit,
                                            const PausePoint& pause) const {
  std::vector<FrontierCandidate> all;
  for (std::size_t k = 0; k < frontiers.size(); ++k) {
    pause();
    const Frontier& f = frontiers[k];
    if (f.area < options_.least_area) continue;
    double cost = path_to_[k].cost;
    const bool searched = path_to_[k].length <= limit;
    if (!searched) {
      double straight = kInfinity;
      for (const Cell c : f.cells) {
        straight = std::min(straight, (traversability_.frame().center(c) - robot).squaredNorm());
      }
      cost = std::max(limit, std::sqrt(straight) - options_.frontiers.near_distance) /
                 options_.cost_to_go.v_max +
             options_.observation_time;
    }
    all.push_back({.frontier = searched ? static_cast<int>(k) : -1, .area = f.area, .cost = cost});
  }
  all = leading_candidates(std::move(all), options_.order, pause);
  return !all.empty() &&
         std::none_of(all.begin(), all.end(), [](const auto& c) { return c.frontier < 0; });
}

// The frontier to go to next, -1 for none; present: that of now, if it will do. alone: only those
// that are worth their path whatever else lies on it.
int FrontierPlanner::choose(const std::vector<Frontier>& frontiers, std::optional<int> present,
                            bool alone, const Prices& prices, FrontierFacts& facts) {
  order_.clear();
  std::vector<FrontierCandidate> candidates;
  for (std::size_t k = 0; k < frontiers.size(); ++k) {
    const Frontier& f = frontiers[k];
    const Path& path = path_to_[k];
    if (f.area < options_.least_area || !(path.length < kInfinity)) continue;
    const auto counted = static_cast<double>(f.cells.size()) - f.ignored_cells;
    candidates.push_back({static_cast<int>(k), f.area, path.cost, path.time, path.length,
                          counted * traversability_.frame().resolution});
  }
  if (candidates.empty()) return -1;
  FrontiersLeft all{static_cast<int>(candidates.size()), 0.0};
  for (const FrontierCandidate& c : candidates) all.area += c.area;
  const auto index_of = [&](int frontier) {
    const auto it = std::find_if(candidates.begin(), candidates.end(),
                                 [&](const auto& c) { return c.frontier == frontier; });
    return it == candidates.end() ? -1 : static_cast<int>(it - candidates.begin());
  };
  // A rule chooses among what is worth its path: one poor frontier must not end its mission.
  if (alone || options_.rule) {
    std::erase_if(candidates, [&](const FrontierCandidate& c) {
      return c.area < options_.least_rate * c.time;
    });
    facts.low_yield = all;
    if (candidates.empty()) return -1;
  }
  if (options_.rule) {
    const int chosen = options_.rule(candidates, present ? index_of(*present) : -1);
    if (chosen < 0 || chosen >= static_cast<int>(candidates.size())) return -1;
    order_ = {candidates[static_cast<std::size_t>(chosen)].frontier};
    return order_.front();
  }

  const int mine = present ? index_of(*present) : -1;
  std::optional<FrontierCandidate> own;
  if (mine >= 0) own = candidates[static_cast<std::size_t>(mine)];
  candidates = leading_candidates(std::move(candidates), options_.order, prices.pause);
  // What it would change from is compared, too, though it may not be among the leading ones.
  if (own && index_of(own->frontier) < 0) candidates.back() = *own;

  std::vector<int> place(frontiers.size(), -1);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    place[static_cast<std::size_t>(candidates[k].frontier)] = static_cast<int>(k);
  }
  struct Viewpoint {
    Cell block;  // of PathLengths
    int candidate;
    double cost;
  };
  std::vector<Viewpoint> viewpoints;
  std::size_t most = 0;  // room for all, so that they are not moved
  for (const FrontierCandidate& c : candidates) {
    most += static_cast<std::size_t>(frontiers[static_cast<std::size_t>(c.frontier)].viewpoints);
  }
  viewpoints.reserve(most);
  std::size_t visited = 0;
  detector_.visit_viewpoints([&](int k, Cell c, Cell sees, double cost) {
    if (++visited % 1024 == 0) prices.pause();
    const int candidate = place[static_cast<std::size_t>(k)];
    if (candidate < 0) return;
    viewpoints.push_back({PathLengths::block_of(c), candidate,
                          cost + (prices.observation ? prices.observation(c, sees) : 0.0)});
  });
  // The cheapest of each candidate in each block.
  std::sort(viewpoints.begin(), viewpoints.end(), [&](const Viewpoint& a, const Viewpoint& b) {
    if (++visited % 1024 == 0) prices.pause();
    if (!(a.block == b.block)) return scan_less(a.block, b.block);
    return a.candidate != b.candidate ? a.candidate < b.candidate : a.cost < b.cost;
  });
  const auto same = [&](const Viewpoint& a, const Viewpoint& b) {
    if (++visited % 1024 == 0) prices.pause();
    return a.block == b.block && a.candidate == b.candidate;
  };
  viewpoints.erase(std::unique(viewpoints.begin(), viewpoints.end(), same), viewpoints.end());
  const auto n = static_cast<Eigen::Index>(candidates.size());
  Eigen::MatrixXd between(n, n);  // [m of path equivalent]
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) {
      between(a, b) = candidates[static_cast<std::size_t>(a)].path +
                      candidates[static_cast<std::size_t>(b)].path;
    }
  }
  if (n > 1) {
    for (Eigen::Index a = 0; a < n; ++a) {
      const int frontier = candidates[static_cast<std::size_t>(a)].frontier;
      between(a, a) = 0.0;
      // No path on shortens what is shorter than the path so far.
      const auto all_found = [&](Cell block, double length) {
        const auto first =
            std::lower_bound(viewpoints.begin(), viewpoints.end(), block,
                             [](const Viewpoint& v, Cell b) { return scan_less(v.block, b); });
        for (auto v = first; v != viewpoints.end() && v->block == block; ++v) {
          double& path = between(a, v->candidate);
          path = std::min(path, length + v->cost);
        }
        return between.row(a).maxCoeff() <= length;
      };
      path_lengths_.flood(between_, path_to_[static_cast<std::size_t>(frontier)].viewpoint,
                          kFarthestBetween * options_.order.patience * options_.cost_to_go.v_max,
                          all_found, prices.pause);
    }
  }
  between = between.array() / options_.cost_to_go.v_max + options_.observation_time;  // [s]
  FrontierSequence next = best_sequence(candidates, between, options_.order);
  if (next.order.empty()) return -1;
  if (!alone && rate(next, candidates, between) < options_.least_rate) return -1;
  if (own) {
    FrontierSequence kept =
        best_sequence(candidates, between, options_.order, index_of(own->frontier));
    if (next.value <= (1.0 + options_.commitment) * kept.value) next = std::move(kept);
  }
  for (const int n : next.order) {
    order_.push_back(candidates[static_cast<std::size_t>(n)].frontier);
  }
  return order_.front();
}

std::vector<FrontierStanding> FrontierPlanner::standings(const std::vector<Frontier>& frontiers,
                                                         int chosen, bool searched_all,
                                                         const PausePoint& pause) const {
  using Why = FrontierStanding::Why;
  std::vector<FrontierStanding> all;
  std::vector<char> ordered(frontiers.size(), 0);
  const auto add = [&](std::size_t k, Why why) {
    all.push_back({static_cast<int>(k), why, frontiers[k].area, path_to_[k].time});
  };
  if (chosen >= 0) {
    for (const int k : order_) {
      ordered[static_cast<std::size_t>(k)] = 1;
      add(static_cast<std::size_t>(k), Why::kInOrder);
    }
  }
  const Why no_path = searched_all ? Why::kNoPath : Why::kFarther;
  const std::size_t first = all.size();
  for (std::size_t k = 0; k < frontiers.size(); ++k) {
    if (k % 512 == 0) pause();
    const Frontier& f = frontiers[k];
    if (!f.active || ordered[k]) continue;
    const double least = options_.least_rate * path_to_[k].time;
    add(k, f.area < options_.least_area        ? Why::kLittle
           : !(path_to_[k].length < kInfinity) ? no_path
           : f.area < least                    ? Why::kLowYield
                                               : Why::kLater);
  }
  std::stable_sort(all.begin() + static_cast<std::ptrdiff_t>(first), all.end(),
                   [](const auto& a, const auto& b) { return a.area > b.area; });
  return all;
}

void FrontierPlanner::summarize_unresolved(const GroundMap& ground, const Pose& pose,
                                           const std::vector<Frontier>& frontiers,
                                           FrontierFacts& facts, const PausePoint& pause) const {
  facts.hemmed_in = !traversability_.passable(field_.anchor());
  // What would be reached if there were no zones, and where it is looked at from.
  const ZoneMap* const zones = options_.traversability.zones.get();
  constexpr int kNone = std::numeric_limits<int>::min() / 4;
  std::vector<Cell> viewpoint(frontiers.size(), Cell{kNone, kNone});
  std::optional<KnownPaths> free;
  if (zones != nullptr) {
    TraversabilityOptions without = options_.traversability;
    without.zones = nullptr;
    free.emplace(ground, pose, without, pose.position.head<2>(), pause);
    detector_.visit_viewpoints([&](int k, Cell c, Cell, double) {
      Cell& best = viewpoint[static_cast<std::size_t>(k)];
      if (free->length(c) < free->length(best)) best = c;
    });
  }
  const auto bars = [&](Cell from) {
    for (const Cell c : free->path(from)) {
      const Eigen::Vector2d center = traversability_.frame().center(c);
      for (int part = 0; part < zones->num_forbidden(); ++part) {
        if (zones->distance(part, center) < options_.traversability.hard_radius) return part;
      }
    }
    return 0;
  };
  for (std::size_t k = 0; k < frontiers.size(); ++k) {
    const Frontier& f = frontiers[k];
    if (!f.active || f.expected_gain < options_.least_area) continue;
    const bool reachable = path_to_[k].length < kInfinity;
    if (reachable && f.area >= options_.least_area) continue;  // its yield is too low: counted
    const bool barred = !reachable && free && free->length(viewpoint[k]) < kInfinity;
    FrontiersLeft& left = barred       ? facts.barred
                          : !reachable ? facts.unreachable
                          : f.given_up ? facts.given_up
                                       : facts.failed;
    ++left.count;
    left.area += f.expected_gain;
    if (barred && facts.barred_by.empty()) {
      facts.barred_by = zones->name(bars(viewpoint[k]));
    }
  }
}

// Map, frontiers, ways and worth as of now.
void FrontierPlanner::take_over(const GroundMap& ground, const Pose& pose, double stamp,
                                const FrontierActivity& activity, const PausePoint& pause) {
  const Eigen::Vector2d p = pose.position.head<2>();
  // What was learned of one place says nothing of another.
  if (!traversability_.continues(ground, pause)) *this = FrontierPlanner(options_);
  if (activity.observed && (been_.empty() || (p - been_.back()).norm() >= kPlaceSpacing)) {
    been_.push_back(p);
  }
  traversability_.update(ground, &pose, pause);
  // A place that could not be passed is no wall: before nothing is left it is tried again.
  const bool open_all = last_->facts.exhausted;
  std::erase_if(closings_, [&](const Closing& c) {
    if (stamp < c.until && !open_all) return false;
    traversability_.reopen(c.at, kHeldUpRadius);
    return true;
  });
  const GridFrame& frame = traversability_.frame();
  if (activity.blocked) {
    const std::optional<Cell> at = held_up_at(frame, p, *activity.blocked);
    if (at) close(*at, stamp);
  }
  detector_.update(traversability_, pause);
  path_lengths_.update(traversability_, pause);
  if (std::exchange(moved_, false)) {
    utility_.map_changed(frame, {}, {}, pause);
  } else {
    utility_.map_changed(frame, traversability_.newly_known(), traversability_.changed_states(),
                         pause);
  }
  if (activity.observed) {
    const ViewpointSource here = detector_.source_at(frame.cell(p.x(), p.y()));
    utility_.observation(traversability_.see_through(), detector_.frontiers(), pose, stamp,
                         here.frontier >= 0 ? std::optional(here.sees) : std::nullopt, pause);
  }
  if (!activity.pursued) progress_.hold(stamp);
  // A loss far from the target says nothing of it, for other paths lead through there, too; but a
  // path on which it is lost again and again does not lead there.
  const bool near = target_ && (frame.center(*target_) - p).norm() <= options_.utility.sensor_range;
  if (activity.got_lost && target_ && (progress_.lost_again() || near)) {
    fail_visit(detector_.frontiers(), TargetChange::kLost, pause);
  }
  const bool anywhere = !options_.area && options_.traversability.zones == nullptr;
  const auto ranges_of = [&](const Frontier& f, std::vector<float>& ranges) {
    utility_.view_ranges(f, ranges);
    for (std::size_t n = 0; n < ranges.size() && !anywhere; ++n) {
      if (!counts(frame.center(f.cells[n]))) ranges[n] = 0.0F;
    }
  };
  detector_.find_viewpoints(traversability_, ranges_of, pause);
}

FrontierPlanner::Prices FrontierPlanner::prices(const FeatureVisibilityMap* visibility_map,
                                                Cell robot, const PausePoint& pause) {
  if (visibility_map == nullptr || !(options_.cost_to_go.lambda > 0.0))
    return {nullptr, nullptr, nullptr, pause};
  count_along_travel(*visibility_map, robot, pause);
  const CostToGoOptions& cost = options_.cost_to_go;
  return {[this, visibility_map, &cost](Cell viewpoint, Cell sees) {
            const double yaw = std::atan2(sees.j - viewpoint.j, sees.i - viewpoint.i);
            return options_.observation_length *
                   cost.localization_price(visibility_map->count(viewpoint, yaw));
          },
          [this, visibility_map, &cost](Cell c, double yaw) {
            return is_priced(c) ? cost.localization_price(visibility_map->count(c, yaw)) : 0.0;
          },
          &along_travel_, pause};
}

// Whether a path leads there; -1: nowhere.
bool FrontierPlanner::set_goal(int frontier, Cell robot, const Prices& prices) {
  detector_.set_goal(frontier, prices.observation, prices.pause);
  field_.update(traversability_, detector_, robot, prices.along, prices.pause);
  return frontier >= 0 && field_.anchor_reached();
}

// Keeps the target or changes it, and leads there.
void FrontierPlanner::keep_or_change_target(const Pose& pose, double stamp, const Prices& prices,
                                            GlobalPlan& global_plan) {
  const std::vector<Frontier>& frontiers = global_plan.frontiers;
  FrontierFacts& facts = global_plan.facts;
  const Cell robot = traversability_.frame().cell(pose.position.x(), pose.position.y());
  const int current = current_target(frontiers, prices.pause);
  TargetChange reason = reason_to_choose(frontiers, current, stamp);
  if (reason == TargetChange::kNone && !set_goal(current, robot, prices)) {
    if (target_) {
      reason = TargetChange::kUnreachable;
    } else {
      // Nothing was left a moment ago.
      facts = last_->facts;
      facts.changed = TargetChange::kNone;
    }
  }
  if (reason == TargetChange::kNone) return;

  std::optional<int> present;  // that of now, which may still be the best
  if (reason == TargetChange::kBetter) present = current;
  int chosen = -1;
  bool searched_all = false;
  // What is near first; where that is not worth its path, there may be what is, far away.
  for (const bool far : {false, true}) {
    searched_all = measure_paths(pose, frontiers, present.value_or(-1), far, prices);
    chosen = choose(frontiers, present, far, prices, facts);
    // The lattice of paths is coarse: what it reaches may still be out of reach.
    while (!set_goal(chosen, robot, prices) && chosen >= 0) {
      path_to_[static_cast<std::size_t>(chosen)].length = kInfinity;
      chosen = choose(frontiers, std::nullopt, far, prices, facts);
    }
    if (chosen >= 0) break;
  }
  chosen_at_ = stamp;
  global_plan.standings = standings(frontiers, chosen, searched_all, prices.pause);
  const double explored = traversability_.explored_area();
  const bool same = chosen >= 0 && chosen == current && target_;
  // A target that was left for a better one has not shown what it could.
  if (!present && target_area_ > 0.0) {
    utility_.learn(target_gain_, target_expected_, explored - explored_then_);
    target_area_ = 0.0;
  }
  if (!same) {
    facts.changed = chosen >= 0 ? reason : TargetChange::kNone;
    progress_.target_dropped();
    target_.reset();
    dropped_ = TargetChange::kFirst;
  }
  if (chosen >= 0 && (!same || !present)) {
    const Frontier& f = frontiers[static_cast<std::size_t>(chosen)];
    target_area_ = f.area;
    target_gain_ = f.expected_gain;
    target_expected_ = f.area / utility_.yield(f.expected_gain);
    explored_then_ = explored;
  }
  facts.exhausted = chosen < 0 && explored > 0.0;
  facts.explored_area = explored;
  if (!facts.exhausted) facts.low_yield = {};
}

// Where the target is, and whether the robot gets on towards it.
void FrontierPlanner::follow_target(double stamp, GlobalPlan& global_plan,
                                    const PausePoint& pause) {
  const GridFrame& frame = traversability_.frame();
  const double explored = traversability_.explored_area();
  FrontierFacts& facts = global_plan.facts;
  if (!field_.anchor_reached()) {
    progress_.begin(stamp, explored);
    progress_.no_target();
    return;
  }
  const ViewpointSource source = detector_.source_at(field_.source_of_anchor());
  if (source.frontier < 0) return;
  const Eigen::Vector2d from = frame.center(source.cell);
  const Eigen::Vector2d to = frame.center(source.sees);
  global_plan.target =
      FrontierTarget{source.frontier, from, to, std::atan2(to.y() - from.y(), to.x() - from.x())};
  const Frontier& f = global_plan.frontiers[static_cast<std::size_t>(source.frontier)];
  facts.target = true;
  facts.target_length = (static_cast<double>(f.cells.size()) - f.ignored_cells) * frame.resolution;
  facts.target_area = f.area;
  facts.path_left = path_left();
  const std::optional<Cell> narrow = narrow_ahead();
  facts.narrow = narrow.has_value();
  progress_.begin(stamp, explored);
  progress_.update(
      facts.changed == TargetChange::kNone, frame.center(field_.anchor()),
      [&](const Eigen::Vector2d& at) { return field_.value(frame.cell(at.x(), at.y())); },
      explored);
  target_ = source.sees;
  if (progress_.hopeless()) {
    progress_.given_up(explored);
    // Else all that lies behind it would be tried in turn.
    if (narrow) close(*narrow, stamp);
    fail_visit(global_plan.frontiers, TargetChange::kNoProgress, pause);
  }
}

std::shared_ptr<const GlobalPlan> FrontierPlanner::update(
    const GroundMap& ground, const Pose& pose, double stamp, const FrontierActivity& activity,
    const FeatureVisibilityMap* visibility_map, const PausePoint& pause) {
  Stopwatch watch;
  // Beyond this the cell address would not fit an int.
  const Eigen::Vector2d p = pose.position.head<2>();
  if (!(p.cwiseAbs().maxCoeff() < kFarthest) || !p.allFinite() || !std::isfinite(pose.yaw) ||
      !std::isfinite(stamp)) {
    return last_;
  }
  take_over(ground, pose, stamp, activity, pause);
  auto global_plan = std::make_shared<GlobalPlan>();
  global_plan->frontiers.reserve(detector_.frontiers().size());
  for (const Frontier& f : detector_.frontiers()) {
    if (global_plan->frontiers.size() % 16 == 0) pause();
    global_plan->frontiers.push_back(f);
  }
  utility_.measure(traversability_, global_plan->frontiers, pause);
  keep_or_change_target(pose, stamp,
                        prices(visibility_map, traversability_.frame().cell(p.x(), p.y()), pause),
                        *global_plan);
  follow_target(stamp, *global_plan, pause);

  FrontierFacts& facts = global_plan->facts;
  facts.stalled_for = progress_.stalled_for();
  facts.stalled = progress_.stalled();
  if (facts.exhausted && chosen_at_ == stamp) {
    summarize_unresolved(ground, pose, global_plan->frontiers, facts, pause);
    facts.cut_off = is_cut_off();
  }
  facts.exhausted_for = exhaustion_.update(stamp, {facts.exhausted, activity.pursued});
  global_plan->map_revision = ground.revision();
  global_plan->stamp = stamp;
  global_plan->cost_to_go = field_.window();
  global_plan->explored_area = traversability_.explored_area();
  global_plan->milliseconds = watch.lap();
  last_ = global_plan;
  return global_plan;
}

void describe(Knobs& knobs, FrontierPlannerOptions& o) {
  describe(knobs, o.frontiers);
  describe(knobs, o.utility);
  describe(knobs, o.order);
  knobs.number("observation_time", o.observation_time, {0.0, 1e3}, "s",
               "of an observation, beside the path to it");
  knobs.number("observation_length", o.observation_length, {0.0, 1e3}, "m",
               "of travel that an observation counts as where features are few");
  knobs.number("reconsider", o.reconsider, {0.01, 1e7}, "s",
               "between two questions whether another target is better");
  knobs.number("commitment", o.commitment, {0.0, 100.0}, "1",
               "share by which another sequence must be better to change the target");
  knobs.number("resolved", o.resolved, {0.0, 0.99}, "1",
               "share of a target's area at whose loss the next one is chosen");
  knobs.number("target_radius", o.target_radius, {0.01, 100.0}, "m",
               "how far a target may move in a step and stay the same");
  knobs.number("closing_time", o.closing_time, {0.0, 1e6}, "s",
               "that a place which could not be passed is impassable, if something else is left");
  describe(knobs, o.cost_to_go);
  describe(knobs, o.traversability);
  knobs.group("progress", [&] { describe(knobs, o.progress); });
}

void describe_end(Knobs& knobs, FrontierPlannerOptions& o) {
  knobs.number("least_area", o.least_area, {0.0, 1e4}, "m2",
               "a frontier expected to show less is not gone to");
  knobs.number("least_rate", o.least_rate, {0.0, 1e3}, "m2/s",
               "nor one that shows less for the time that it takes");
}

}  // namespace prospect
