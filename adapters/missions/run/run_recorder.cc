// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/run_recorder.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>
#include <utility>

#include "adapters/formats/images/image_codec.h"
#include "adapters/missions/run/configured_record.h"
#include "adapters/missions/run/summary.h"
#include "adapters/missions/run/unmeasured.h"
#include "engine/maps/correction.h"
#include "engine/planner/planning_step.h"
#include "engine/terms/builtin_terms.h"
#include "models/formatted.h"

namespace prospect {
namespace {

std::vector<FrontierRecord> frontier_records(const GlobalPlan& global_plan) {
  std::vector<FrontierRecord> records;
  records.reserve(global_plan.standings.size());
  for (const FrontierStanding& standing : global_plan.standings) {
    const Frontier& frontier = global_plan.frontiers[static_cast<std::size_t>(standing.frontier)];
    records.push_back(
        {frontier.centroid, standing.why, standing.area, frontier.expected_gain, standing.time});
  }
  return records;
}

/// The target and the three after it, then how many of the others there are, by why they are not.
/// Without commas, which programs that read tables by them would take for columns.
std::string standings_text(const std::vector<FrontierRecord>& all) {
  constexpr std::size_t kNamed = 4;
  using Why = FrontierStanding::Why;
  constexpr Why kOthers[] = {Why::kLater, Why::kFarther, Why::kLowYield, Why::kLittle,
                             Why::kNoPath};
  std::string next, others;
  for (std::size_t n = 0; n < std::min(kNamed, all.size()) && all[n].why == Why::kInOrder; ++n) {
    next += formatted("%s%.2f m2 in %.1f s at %.2f %.2f", n > 0 ? "; " : "", all[n].area,
                      all[n].time, all[n].place.x(), all[n].place.y());
  }
  for (const Why why : kOthers) {
    const auto count =
        std::count_if(all.begin(), all.end(), [&](const auto& s) { return s.why == why; });
    if (count == 0) continue;
    others += (others.empty() ? "" : "; ") + std::to_string(count) + ' ' + std::string(name(why));
  }
  return next + (next.empty() || others.empty() ? "" : "; ") + others;
}

/// Cells whose state differs from what was last recorded.
class MapChanges {
 public:
  /// anew: a map that has taken the place of another one, whose revisions say nothing of this.
  std::vector<std::pair<Cell, CellState>> since_last(const GroundMap& ground, bool anew) {
    if (anew) revision_ = 0;
    std::vector<std::pair<Cell, CellState>> changes;
    const GridFrame& frame = ground.frame();
    if (!(frame == shown_.frame)) {
      Grid<CellState> wider(frame, CellState::kUnknown);
      for (int i = 0; i < shown_.frame.size(); ++i) {
        const Cell c = shown_.frame.at(i);
        if (frame.contains(c)) wider[c] = shown_[c];
      }
      shown_ = std::move(wider);
    }
    for (int ty = 0; ty < ground.tiles_y(); ++ty) {
      for (int tx = 0; tx < ground.tiles_x(); ++tx) {
        if (!anew && ground.tile_revision(tx, ty) <= revision_) continue;
        const GridFrame tile = ground.tile_frame(tx, ty);
        for (int i = 0; i < tile.size(); ++i) {
          const Cell c = tile.at(i);
          const CellState state = ground.state(c);
          if (shown_[c] == state) continue;
          shown_[c] = state;
          changes.emplace_back(c, state);
        }
      }
    }
    revision_ = ground.revision();
    return changes;
  }

 private:
  Grid<CellState> shown_{GridFrame{0.1, 0, 0, 0, 0}, CellState::kUnknown};
  std::uint64_t revision_ = 0;
};

/// Chooses at most `most` steps of a run whose length is not known before, evenly spread: those
/// that are multiples of a power of two.
class EvenlySpread {
 public:
  explicit EvenlySpread(int most) : most_(most) {}
  /// Whether a step is chosen. thin(others) first lets go of those chosen before of which
  /// others(step) holds, and gives how many are left.
  template <class Thin>
  bool chooses(int step, const Thin& thin) {
    const auto others = [this](int n) { return n % every_ != 0; };
    if (others(step)) return false;
    if (count_ == most_) {
      every_ *= 2;
      count_ = thin(others);
      if (others(step)) return false;
    }
    ++count_;
    return true;
  }

 private:
  const int most_;
  int every_ = 1;
  int count_ = 0;
};

/// Pictures of the camera, of some steps that have one.
class SparsePictures {
 public:
  void add(int step, const CameraPicture& shown) {
    if (!shown.image || shown.image->pixels.empty()) return;
    const bool chosen = steps_.chooses(step, [this](const auto& others) {
      std::erase_if(pictures_, [&](const LandmarkPicture& p) { return others(p.frame); });
      return static_cast<int>(pictures_.size());
    });
    if (chosen) {
      pictures_.push_back(landmark_picture(step, *shown.image, shown.sightings, kWidth));
    }
  }
  std::vector<LandmarkPicture> take() { return std::move(pictures_); }

 private:
  static constexpr int kWidth = 360;  // [px]
  EvenlySpread steps_{300};
  std::vector<LandmarkPicture> pictures_;
};

/// Pictures of the cost-to-go, of some steps.
class SparseCostsToGo {
 public:
  void add(std::vector<StepRecord>& steps, StepRecord& now, const CostToGo& cost_to_go) {
    const bool chosen = steps_.chooses(now.step, [&](const auto& others) {
      int left = 0;
      for (StepRecord& step : steps) {
        if (others(step.step)) step.cost_to_go.reset();
        left += step.cost_to_go.has_value();
      }
      return left;
    });
    if (chosen) now.cost_to_go = picture(cost_to_go);
  }

 private:
  /// Every other cell; those that were not reached say nothing.
  static CostToGoPicture picture(const CostToGo& cost_to_go) {
    const GridFrame& fine = cost_to_go.frame();
    CostToGoPicture coarse;
    coarse.frame = frame_of_blocks(fine, kCostToGoCoarser);
    for (int k = 0; k < coarse.frame.size(); ++k) {
      const Eigen::Vector2d center = coarse.frame.center(coarse.frame.at(k));
      const Cell c = fine.cell(center.x(), center.y());
      coarse.seconds.push_back(cost_to_go.reached(c) ? static_cast<float>(cost_to_go.cells()[c])
                                                     : std::numeric_limits<float>::quiet_NaN());
    }
    return coarse;
  }

  EvenlySpread steps_{150};
};

/// Its memory, too: to assign {} would keep that.
template <class Value>
void release(std::vector<Value>& values) {
  values = std::vector<Value>();
}

/// All of a plan that a report can do without.
void forget(StepRecord& step) {
  release(step.horizon);
  release(step.candidates);
  release(step.landmarks);
  release(step.frontier_cells);
  release(step.standings);
  release(step.movers);
}

/// Plans in full (horizon, candidates, landmarks, frontier cells), of some steps, so that a mission
/// of hours needs no more memory for them than one of minutes.
class SparsePlans {
 public:
  void add(std::vector<StepRecord>& steps, StepRecord& now) {
    const bool chosen = steps_.chooses(now.step, [&](const auto& others) {
      int left = 0;
      for (StepRecord& step : steps) {
        if (others(step.step)) {
          forget(step);
        } else {
          ++left;
        }
      }
      return left;
    });
    if (!chosen) forget(now);
  }

 private:
  EvenlySpread steps_{4000};
};

std::vector<CandidateRecord> candidate_records(const Plan& plan, const Problem* problem,
                                               const MotionModel& model) {
  std::vector<CandidateRecord> records;
  for (const PlanCandidate& c : plan.candidates) {
    CandidateRecord record{c.name, c.polished, c.verdict, {}, {}};
    record.explanation.cost = c.cost;
    record.explanation.violation = c.violation;
    if (problem != nullptr) {
      record.explanation =
          c.verdict.kind == Verdict::Kind::kExecuted ? plan.explanation : problem->explain(c.z);
      const TrajectoryBatch t = problem->rollout(c.z);
      const int nx = t.horizon.nx();
      for (int k = 0; k <= t.horizon.N; ++k) {
        const Pose pose =
            model.pose(Eigen::Map<const Eigen::VectorXd>(t.states.data() + k * nx, nx));
        record.path.push_back(pose.position.head<2>().cast<float>());
      }
    }
    records.push_back(std::move(record));
  }
  return records;
}

/// Of the costs of the step's problem.
std::vector<TermWeight> term_weights(const Problem& problem,
                                     const ProblemSpecification::Weights& asked) {
  std::vector<TermWeight> weights;
  for (const ProblemDefinition::WeightedTerm& t : problem.definition().terms) {
    if (t.term->traits().kind == TermKind::kConstraint) continue;
    const std::string name(t.term->name());
    weights.push_back({name, builtin_weight(name, asked).value_or(t.weight), t.weight});
  }
  return weights;
}

}  // namespace

struct RunRecorder::Impl {
  Impl(const Configuration& c, std::uint64_t its_seed, bool keeps)
      : configuration(c), seed(its_seed), keep_steps(keeps) {
    if (keep_steps) load_image_codecs_if_there();
  }

  const Configuration& configuration;
  const std::uint64_t seed;
  const bool keep_steps;
  std::vector<RunObserver*> observers;
  const std::chrono::steady_clock::time_point begun = std::chrono::steady_clock::now();
  std::mutex mutex;
  CameraPicture picture;  // the newest
  Unmeasured unmeasured;
  MapChanges map_changes;
  SparsePictures pictures;
  SparseCostsToGo costs_to_go;
  SparsePlans plans;
  std::vector<StepRecord> steps;
  int corrections = 0;  // up to the step before
  int moved = 0;        // newest correction that moved what was measured

  StepRecord record_of(const MissionStep& step);
  void add(const MissionStep& step);
  RunRecord finish(const MissionResult& mission, const std::string& world, const Truth* truth,
                   const ReachableArea* reachable);
};

StepRecord RunRecorder::Impl::record_of(const MissionStep& step) {
  const Plan& plan = *step.plan;
  const Belief& belief = *step.belief;
  const TrueState estimated = unmeasured.at(belief);
  const TrueState& truth = step.truth ? *step.truth : estimated;
  const Problem* const problem = step.made ? step.made->problem.get() : nullptr;
  StepRecord r;
  r.step = step.index;
  r.time = step.time;
  r.stamp = belief.stamp;
  r.true_pose = truth.pose;
  r.estimated_pose = belief.pose;
  if (!plan.commands.empty()) r.command = plan.commands.front();
  r.plan_kind = plan.kind;
  r.task = plan.task;
  if (plan.goal) {
    r.goal = plan.goal->position;
    r.goal_yaw = plan.goal->yaw;
  }
  r.mode = plan.mode.kind;
  r.cause = plan.mode.cause;
  // The first mode holds from the start, whatever a running clock says then.
  r.mode_since = std::max(0.0, step.time - (belief.stamp - plan.mode.since));
  r.safety_level = plan.safety_level;
  r.why = plan.why;
  r.seeds_scored = plan.seeds_scored;
  r.features_weight = plan.features_weight;
  r.seed = plan.seed;
  r.explanation = plan.explanation;
  if (problem != nullptr && !plan.explanation.terms.empty()) {
    r.weights = term_weights(*problem, configuration.planner.weights);
  }
  const auto committed = static_cast<std::size_t>(std::max(0, plan.committed));
  if (committed < plan.visible.size()) r.predicted_features = plan.visible[committed];
  r.tracked_features = belief.tracked_features;
  r.localization = belief.localization;
  r.coverage = truth.coverage;
  r.area = truth.seen_area;
  r.localization_error = truth.localization_error;
  r.path_length = truth.path_length;
  r.collisions = truth.collisions;
  for (const TermValue& term : plan.explanation.terms) {
    if (term.quantity != TermQuantity::kClearance) continue;
    r.clearance = term.raw + configuration.planner.d_safe;
  }
  r.cost_evaluations = plan.counters.cost_evaluations;
  r.gradient_evaluations = plan.counters.gradient_evaluations;
  r.stop_reason = plan.stop;
  r.quality = plan.quality;
  r.certified = plan.certified;
  r.certificate = plan.certified ? plan.certificate : plan.detail;
  r.guard_stops = step.guard_stops;
  if (step.guard_stops > 0) r.guard_reason = step.guard_reason;
  int newest_move = 0;
  if (const MapFrame* frame = belief.map_frame.get()) {
    r.map_frame =
        MapFrameRecord{frame->origin, frame->taken, frame->refused + frame->cannot_follow};
    if (frame->taken > corrections && frame->newest) {
      r.map_frame->distance = frame->newest->distance;
      r.map_frame->turn = frame->newest->turn;
      r.map_frame->why = frame->newest->why;
    }
    corrections = frame->taken;
    newest_move = frame->moved_places.empty() ? 0 : frame->moved_places.back().taken;
  }
  r.wall = {plan.times.total, plan.times.frontier_planner, plan.times.clearance, plan.times.views,
            plan.times.seeds, plan.times.polish,           plan.times.certify};
  r.age = plan.age;
  if (step.global_plan) {
    std::size_t cells = 0;
    for (const Frontier& f : step.global_plan->frontiers) cells += f.active ? f.cells.size() : 0;
    r.frontier_cells.reserve(cells);
    for (const Frontier& f : step.global_plan->frontiers) {
      if (!f.active) continue;
      ++r.active_frontiers;
      for (const Cell& cell : f.cells) {
        r.frontier_cells.push_back(belief.ground->frame().center(cell).cast<float>());
      }
    }
  }
  for (const Eigen::VectorXd& x : plan.states) {
    r.horizon.push_back(configuration.robot.model->pose(x));
  }
  if (step.global_plan) {
    const GlobalPlan& global_plan = *step.global_plan;
    r.target_change = global_plan.facts.changed;
    r.standings = frontier_records(global_plan);
    r.frontiers = standings_text(r.standings);
    if (global_plan.target) {
      r.target = TargetRecord{global_plan.target->viewpoint, global_plan.target->looks_at,
                              global_plan.facts.target_length, global_plan.facts.target_area,
                              global_plan.facts.path_left};
    }
    if (keep_steps) costs_to_go.add(steps, r, *global_plan.cost_to_go);
  }
  r.candidates =
      candidate_records(plan, keep_steps ? problem : nullptr, *configuration.robot.model);
  if (step.made) {
    const std::vector<ConsideredLandmark>& landmarks = step.made->landmarks;
    r.landmarks.reserve(landmarks.size());
    for (const ConsideredLandmark& considered : landmarks) {
      const Eigen::Vector3d& position = considered.landmark.position;
      r.landmarks.push_back({static_cast<float>(position.x()), static_cast<float>(position.y()),
                             static_cast<float>(considered.visibility)});
    }
  }
  r.movers = predicted(belief.movers.get(), belief.stamp);
  r.map_changes =
      map_changes.since_last(*belief.ground, std::exchange(moved, newest_move) != newest_move);
  return r;
}

void RunRecorder::Impl::add(const MissionStep& step) {
  StepRecord r = record_of(step);
  if (keep_steps) {
    CameraPicture shown;
    {
      const std::lock_guard lock(mutex);
      shown = picture;
    }
    pictures.add(r.step, shown);
  }
  for (RunObserver* observer : observers) observer->on_record(r, step);
  if (!keep_steps) {
    forget(r);
    release(r.map_changes);
  } else {
    plans.add(steps, r);
  }
  steps.push_back(std::move(r));
}

RunRecord RunRecorder::Impl::finish(const MissionResult& mission, const std::string& world,
                                    const Truth* measured, const ReachableArea* reachable) {
  const TrueState truth = measured != nullptr ? measured->newest() : unmeasured.newest();
  RunRecord record = configured_record(configuration);
  record.summary = summarize(steps);
  Summary& s = record.summary;
  s.world = world;
  s.solver = configuration.solver;
  s.seed = seed;
  s.measured = measured != nullptr;
  s.task = to_string(configuration.planner.task.kind);
  s.end = mission.end;
  s.done = mission.done();
  s.detail = mission.detail;
  if (mission.turned_back_at) s.turned_back_s = *mission.turned_back_at;
  if (mission.heading_missed) s.heading_missed_deg = *mission.heading_missed * 180.0 / M_PI;
  s.coverage = truth.coverage;
  s.area_m2 = truth.seen_area;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  s.reachable_area_m2 = reachable ? reachable->area : kUnknown;
  s.too_long_for_m2 = reachable ? reachable->too_long_for : kUnknown;
  s.collisions = truth.collisions;
  s.losses = truth.losses;
  s.duration_s = mission.duration;
  s.path_length_m = truth.path_length;
  s.fallbacks = mission.fallbacks;
  s.guard_stops = mission.guard_stops;
  s.steps = mission.steps;
  if (configuration.planner.deadline > 0.0) {
    for (const StepRecord& step : steps) {
      s.deadline_misses += step.wall.plan > 1e3 * configuration.planner.deadline;
    }
  }
  if (keep_steps) record.steps = std::move(steps);
  record.pictures = pictures.take();
  s.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return record;
}

RunRecorder::RunRecorder(const Configuration& configuration, std::uint64_t seed, bool keep_steps)
    : impl_(std::make_unique<Impl>(configuration, seed, keep_steps)) {}
RunRecorder::~RunRecorder() = default;

void RunRecorder::watched_by(std::vector<RunObserver*> observers) {
  impl_->observers = std::move(observers);
}

void RunRecorder::on_picture(const CameraPicture& picture) {
  const std::lock_guard lock(impl_->mutex);
  impl_->picture = picture;
}

void RunRecorder::on_step(const MissionStep& step) { impl_->add(step); }

RunRecord RunRecorder::finish(const MissionResult& mission, const std::string& world,
                              const Truth* truth, const ReachableArea* reachable) {
  return impl_->finish(mission, world, truth, reachable);
}

}  // namespace prospect
