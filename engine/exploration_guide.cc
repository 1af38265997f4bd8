#include "engine/exploration_guide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/stopwatch.h"

namespace prospect {
namespace {

constexpr double kPassageAhead =
    2.0;  // [m] how far ahead the passage that held the robot up may lie
constexpr double kPassageRadius = 0.3;  // [m] of the disc that is closed around its narrowest cell
// [m] how far ahead of a robot that does not get on such a disc is closed: beyond its own cell.
constexpr double kBlockedAhead = 0.4;
constexpr double kPlaceSpacing = 0.5;  // [m] between the places where the robot has been

}  // namespace

ExplorationGuide::ExplorationGuide(const ExplorationGuideOptions& options)
    : options_(options),
      traversability_(options.traversability),
      detector_(options.frontiers),
      memory_(options.memory),
      area_(options.area_depth),
      field_(options.cost_to_go),
      low_yield_(options.low_yield) {
  const auto require = [](const char* name, double value, double below, const char* expected) {
    if (value >= 0.0 && value < below) return;
    throw std::invalid_argument("exploration guide: " + std::string(name) + " = " +
                                std::to_string(value) + "; expected " + expected);
  };
  require("kappa", options.kappa, 100.0, "0 to 100 m");
  require("kappa_area", options.kappa_area, 100.0, "0 to 100 m");
  require("ample_room", options.ample_room, 10.0, "0 to 10 m");
  require("look_length", options.look_length, 100.0, "0 to 100 m");
  if (options.area) {
    const std::string fault = polygon_fault(*options.area);
    if (!fault.empty()) throw std::invalid_argument("exploration guide: area: " + fault);
  }
  new_ground_ = options_.memory.retry_area;
  auto empty = std::make_shared<Guidance>();
  empty->cost_to_go = std::make_shared<const CostToGo>();
  last_ = std::move(empty);
}

// The passable cells with at least `room` clearance [m] that are joined to `start` by such cells
// (4-connected, as the cost-to-go).
void ExplorationGuide::flood(Cell start, double room) {
  const Grid<float>& factors = traversability_.factors();
  const GridFrame& frame = factors.frame;
  component_.assign(factors.data.size(), 0);
  stack_.clear();
  const auto visit = [&](int index) {
    const auto at = static_cast<std::size_t>(index);
    if (factors.data[at] == 0.0F || component_[at] != 0) return;
    if (room > 0.0 && traversability_.clearance(frame.at(index)) < room) return;
    component_[at] = 1;
    stack_.push_back(index);
  };
  if (frame.contains(start)) visit(frame.index(start));
  while (!stack_.empty()) {
    const int index = stack_.back();
    stack_.pop_back();
    // The outermost cells are impassable: all four neighbours exist.
    for (const int n : {index - 1, index + 1, index - frame.width, index + frame.width}) visit(n);
  }
}

// The passable cell with at least `room` clearance [m] that is the fewest steps from `start`,
// through free cells; `start` if there is none.
Cell ExplorationGuide::nearest_with(double room, Cell start) {
  const GridFrame& frame = traversability_.frame();
  component_.assign(static_cast<std::size_t>(frame.size()), 0);
  stack_.clear();
  const auto visit = [&](Cell c) {
    if (!frame.contains(c) || traversability_.state(c) != CellState::kFree) return;
    std::uint8_t& visited = component_[static_cast<std::size_t>(frame.index(c))];
    if (visited == 0) stack_.push_back(frame.index(c));
    visited = 1;
  };
  visit(start);
  for (std::size_t next = 0; next < stack_.size(); ++next) {
    const Cell c = frame.at(stack_[next]);
    if (traversability_.passable(c) && traversability_.clearance(c) >= room) return c;
    for (const Cell n :
         {Cell{c.i - 1, c.j}, Cell{c.i + 1, c.j}, Cell{c.i, c.j - 1}, Cell{c.i, c.j + 1}}) {
      visit(n);
    }
  }
  return start;
}

// Frontiers with a viewpoint in the robot's component.
void ExplorationGuide::mark_reachable(std::vector<Frontier>& frontiers) {
  if (!field_.anchor_reached()) return;
  flood(field_.anchor());
  detector_.mark_seen_from(component_, frontiers);
}

// Places that are impassable by now say nothing: a wall drawn twice covers some of any room.
bool ExplorationGuide::is_cut_off() {
  flood(field_.anchor());
  const GridFrame& frame = traversability_.frame();
  int joined = 0, cut_off = 0;
  for (const Eigen::Vector2d& place : been_) {
    const Cell c = frame.cell(place.x(), place.y());
    if (!traversability_.passable(c)) continue;
    ++(component_[static_cast<std::size_t>(frame.index(c))] != 0 ? joined : cut_off);
  }
  return cut_off > joined;
}

std::shared_ptr<const Guidance> ExplorationGuide::update(const GroundMap& ground, const Pose& pose,
                                                         double stamp,
                                                         const GuideAttention& attention,
                                                         const FeatureOutlook* outlook,
                                                         const BonusRule& rule) {
  Stopwatch watch;
  // Beyond this the cell address would not fit an int.
  const Eigen::Vector2d p = pose.position.head<2>();
  if (!(p.cwiseAbs().maxCoeff() < kFarthest) || !p.allFinite() || !std::isfinite(pose.yaw) ||
      !std::isfinite(stamp)) {
    return last_;
  }
  // What was learned of one place says nothing of another.
  if (!traversability_.continues(ground)) *this = ExplorationGuide(options_);
  const double explored = traversability_.explored_area();
  const bool not_low = low_yield_.update(stamp, explored);
  const SearchFacts grown{.new_ground = not_low || explored - ordinary_explored_ >= new_ground_};
  if (const SearchRow* row = next_search(search_, grown)) {
    restart(row->to);
    new_ground_ *= 2.0;  // as FrontierMemory::retry_area(), for the same reason
    reopenings_ = 0;
  }
  if (attention.looked && (been_.empty() || (p - been_.back()).norm() >= kPlaceSpacing)) {
    been_.push_back(p);
  }
  std::shared_ptr<Guidance> guidance = step(ground, pose, stamp, attention, outlook, rule);
  while (guidance->facts.exhausted) {
    const SearchRow* row = next_search(search_, {.nothing_reachable = true,
                                                 .passage_closed = passage_closed_,
                                                 .may_reopen = reopenings_ < options_.reopenings});
    if (row == nullptr) break;
    if (row->from == Search::kOrdinary) {
      low_yield_.begin(stamp, guidance->explored_area);
      ordinary_explored_ = guidance->explored_area;
    }
    if (row->from == row->to) ++reopenings_;
    restart(row->to);
    if (row->try_all_again) memory_.forgive();
    // What was in view is counted already.
    guidance =
        step(ground, pose, stamp, {.looked = false, .pursued = attention.pursued}, outlook, rule);
  }
  FrontierFacts& facts = guidance->facts;
  facts.search = search_;
  facts.exhausted_for = exhaustion_.update(stamp, facts.exhausted, attention.pursued);
  facts.yield_too_low = low_yield_.up(stamp);
  facts.cut_off = (facts.exhausted || facts.yield_too_low) && is_cut_off();
  guidance->milliseconds = watch.lap();
  last_ = guidance;
  return guidance;
}

void ExplorationGuide::restart(Search search) {
  search_ = search;
  restarted_ = true;
  TraversabilityOptions traversability = options_.traversability;
  FrontierOptions frontiers = options_.frontiers;
  if (search == Search::kNarrowPassages) traversability.lattice_slack += options_.relaxed_slack;
  if (search != Search::kOrdinary) {
    frontiers.min_length = std::min(frontiers.min_length, options_.relaxed_length);
  }
  passage_closed_ = false;
  traversability_ = Traversability(traversability);
  detector_ = FrontierDetector(frontiers);
  field_ = CostToGoField(options_.cost_to_go);
}

// The robot travels down the field of the step before. Where that says nothing, nor do the counts.
void ExplorationGuide::count_along_travel(const FeatureOutlook& outlook) {
  const GridFrame& frame = traversability_.frame();
  along_travel_.frame = frame;
  along_travel_.data.assign(static_cast<std::size_t>(frame.size()),
                            std::numeric_limits<float>::infinity());
  for (int index = 0; index < frame.size(); ++index) {
    const Cell c = frame.at(index);
    const double here = field_.value(c);
    if (!(here < std::numeric_limits<double>::infinity())) continue;
    // Upwind, as the field was solved: towards the lower neighbour.
    const auto descent = [&](int di, int dj) {
      const double ahead = field_.value({c.i + di, c.j + dj});
      const double behind = field_.value({c.i - di, c.j - dj});
      if (!(std::min(ahead, behind) < here)) return 0.0;
      return ahead < behind ? here - ahead : behind - here;
    };
    const double x = descent(1, 0), y = descent(0, 1);
    if (x == 0.0 && y == 0.0) continue;
    along_travel_[c] = static_cast<float>(outlook.count(c, std::atan2(y, x)));
  }
}

// The neighbour at which the field is lowest; c itself if it is nowhere lower.
Cell ExplorationGuide::downhill(Cell c) const {
  Cell best = c;
  for (int dj = -1; dj <= 1; ++dj) {
    for (int di = -1; di <= 1; ++di) {
      const Cell n{c.i + di, c.j + dj};
      if (field_.value(n) < field_.value(best)) best = n;
    }
  }
  return best;
}

// The first place on the way down that is too narrow for the ordinary radius.
void ExplorationGuide::close_passage() {
  const GridFrame& frame = traversability_.frame();
  const Cell goal = field_.source_of_anchor();
  const int steps = static_cast<int>(kPassageAhead / frame.resolution);
  Cell c = field_.anchor();
  for (int step = 0; step < steps; ++step) {
    if (traversability_.clearance(c) + options_.traversability.lattice_slack <
        options_.traversability.hard_radius) {
      traversability_.close(c, kPassageRadius);
      passage_closed_ = true;
      detector_.update(traversability_);
      return;
    }
    if (c == goal) return;
    const Cell next = downhill(c);
    if (next == c) return;
    c = next;
  }
}

// [m] from the robot's cell down the field to where it ends; 0 where it is not reached.
double ExplorationGuide::way_left() const {
  if (!field_.anchor_reached()) return 0.0;
  const double r = traversability_.frame().resolution;
  const Cell goal = field_.source_of_anchor();
  Cell c = field_.anchor();
  double length = 0.0;
  while (!(c == goal)) {
    const Cell next = downhill(c);
    if (next == c) break;
    length += r * std::hypot(next.i - c.i, next.j - c.j);
    c = next;
  }
  return length;
}

bool ExplorationGuide::counts(const Eigen::Vector2d& p) const {
  const ZoneMap* zones = options_.traversability.zones.get();
  return (!options_.area || contains(*options_.area, p)) &&
         (zones == nullptr || zones->distance(p) > 0.0);
}

void ExplorationGuide::leave_out_what_does_not_count() {
  if (!options_.area && options_.traversability.zones == nullptr) return;
  for (const Frontier& frontier : detector_.frontiers()) {
    for (const Cell c : frontier.cells) {
      if (!counts(suppressed_.frame.center(c))) suppressed_[c] = 1;
    }
  }
}

// kappa log(1 + l) + kappa_area log(1 + A)
std::vector<double> ExplorationGuide::size_bonuses(Cell robot) {
  const std::vector<Frontier>& frontiers = detector_.frontiers();
  std::vector<double> bonus;
  bonus.reserve(frontiers.size());
  for (const Frontier& f : frontiers) {
    const auto counted = static_cast<double>(f.cells.size()) - f.suppressed_cells;
    bonus.push_back(options_.kappa * std::log1p(counted * detector_.frame().resolution));
  }
  if (options_.kappa_area == 0.0 || search_ != Search::kOrdinary) return bonus;
  const std::vector<double> area = area_.measure(traversability_, frontiers, suppressed_);
  const TraversabilityOptions& t = options_.traversability;
  const double room =
      std::min(t.hard_radius + options_.ample_room, t.comfortable_radius) - t.lattice_slack;
  flood(nearest_with(room, robot), room);
  std::vector<Frontier> seen = frontiers;
  detector_.mark_seen_from(component_, seen);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].reachable) bonus[i] += options_.kappa_area * std::log1p(area[i]);
  }
  return bonus;
}

std::vector<double> ExplorationGuide::bonuses(const BonusQuestion& question,
                                              const BonusRule& rule) {
  const std::vector<Frontier>& frontiers = detector_.frontiers();
  std::vector<double> bonus;
  if (rule) {
    bonus = rule(question);
    bonus.resize(frontiers.size(), 0.0);
  } else {
    bonus = size_bonuses(question.robot);
  }
  if (question.current >= 0) {
    bonus[static_cast<std::size_t>(question.current)] += options_.memory.hysteresis;
  }
  return bonus;
}

std::shared_ptr<Guidance> ExplorationGuide::step(const GroundMap& ground, const Pose& pose,
                                                 double stamp, const GuideAttention& attention,
                                                 const FeatureOutlook* outlook,
                                                 const BonusRule& rule) {
  const Eigen::Vector2d p = pose.position.head<2>();
  traversability_.update(ground);
  if (attention.blocked && attention.blocked->allFinite()) {
    const Eigen::Vector2d ahead = p + kBlockedAhead * *attention.blocked;
    const Cell at = traversability_.frame().cell(ahead.x(), ahead.y());
    if (traversability_.frame().contains(at)) traversability_.close(at, kPassageRadius);
  }
  detector_.update(traversability_);
  if (!restarted_) {
    memory_.map_changed(traversability_.newly_known(), traversability_.changed_states());
  }
  restarted_ = false;
  if (attention.looked) {
    memory_.look(traversability_.see_through(), detector_.frontiers(), pose, stamp);
  }
  if (!attention.pursued) memory_.hold_clock(stamp);

  const GridFrame& frame = traversability_.frame();
  if (attention.got_lost) memory_.put_off_target(detector_.frontiers(), frame, p);
  const Cell robot = frame.cell(p.x(), p.y());
  auto guidance = std::make_shared<Guidance>();
  const Grid<float>* along = nullptr;
  LookPrice price;
  if (outlook != nullptr && options_.cost_to_go.lambda > 0.0) {
    count_along_travel(*outlook);
    along = &along_travel_;
    price = [&](Cell viewpoint, Cell sees) {
      const double yaw = std::atan2(sees.j - viewpoint.j, sees.i - viewpoint.i);
      return options_.look_length *
             options_.cost_to_go.localization_price(outlook->count(viewpoint, yaw));
    };
  }
  // Suppressing or reactivating changes the sources, so the cost-to-go is repaired and the question
  // put again; the memory does so at most once a retry and once for a stall.
  for (bool again = true; again;) {
    memory_.suppression(frame, suppressed_);
    leave_out_what_does_not_count();
    detector_.find_viewpoints(traversability_, suppressed_);
    const std::vector<Frontier>& frontiers = detector_.frontiers();
    const int current = memory_.current_target(frontiers, frame);
    BonusQuestion question{traversability_, detector_, current, robot};
    const std::vector<double> bonus = bonuses(question, rule);
    detector_.set_bonuses(bonus, price);
    field_.update(traversability_, detector_, robot, along);
    if (rule && !field_.anchor_reached()) {
      question.unreached = true;
      const std::vector<double> second = bonuses(question, rule);
      if (second != bonus) {
        detector_.set_bonuses(second, price);
        field_.update(traversability_, detector_, robot, along);
      }
    }

    guidance->target.reset();
    guidance->facts = {};
    std::optional<std::pair<int, Cell>> target;
    double value = 0.0;
    if (field_.anchor_reached()) {
      const ViewpointSource source = detector_.source_at(field_.source_of_anchor());
      if (source.frontier >= 0) {
        target = {source.frontier, source.sees};
        value = field_.value(field_.anchor());
        if (source.frontier == current) value += options_.memory.hysteresis;
        const Eigen::Vector2d from = frame.center(source.cell);
        const Eigen::Vector2d to = frame.center(source.sees);
        guidance->target = FrontierTarget{source.frontier, from, to,
                                          std::atan2(to.y() - from.y(), to.x() - from.x())};
        const auto at = static_cast<std::size_t>(source.frontier);
        const auto counted =
            static_cast<double>(frontiers[at].cells.size()) - frontiers[at].suppressed_cells;
        guidance->facts.target = true;
        guidance->facts.target_length = counted * frame.resolution;
        guidance->facts.target_worth =
            bonus[at] - (source.frontier == current ? options_.memory.hysteresis : 0.0);
      }
    }
    const double explored = traversability_.explored_area();
    if (explored == 0.0) {
      again = false;  // nothing seen yet is not everything seen
    } else {
      const int given_up = memory_.given_up();
      const FrontierMemory::Verdict verdict =
          memory_.judge(frontiers, frame, target, p, value, explored, stamp);
      again = verdict == FrontierMemory::Verdict::kAskAgain;
      guidance->facts.exhausted = verdict == FrontierMemory::Verdict::kNothingLeft;
      if (search_ == Search::kNarrowPassages && memory_.given_up() > given_up) close_passage();
    }
  }

  guidance->map_revision = ground.revision();
  guidance->stamp = stamp;
  guidance->frontiers = detector_.frontiers();
  mark_reachable(guidance->frontiers);
  guidance->cost_to_go = field_.window();
  guidance->explored_area = traversability_.explored_area();
  guidance->facts.stalled_for = memory_.progress().stalled_for();
  guidance->facts.stalled = memory_.progress().stalled();
  guidance->facts.way_left = way_left();
  guidance->retries_used = memory_.retries_used();
  guidance->suppressed_cells = memory_.suppressed_count();
  return guidance;
}

}  // namespace prospect
