#include "adapters/run/exploration_run.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "adapters/files/input_error.h"
#include "adapters/run/summary.h"
#include "adapters/simulator/faulty_disk.h"
#include "adapters/simulator/faulty_replanner.h"
#include "adapters/simulator/faulty_scan.h"
#include "adapters/simulator/simulated_base.h"
#include "adapters/simulator/simulator.h"
#include "adapters/worlds/octree_file.h"
#include "engine/planner/frontier_planner_options.h"
#include "engine/planner/planner.h"
#include "engine/planner/planner_guard.h"
#include "engine/task/zone_map.h"
#include "models/range_text.h"
#include "runtime/clock.h"
#include "runtime/mission.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

/// The simulator as a robot: commands in, beliefs out.
class SimulatedRobot final : public Robot {
 public:
  explicit SimulatedRobot(Simulator& simulator) : simulator_(simulator) {}
  std::shared_ptr<const Belief> sense() override { return simulator_.sense(); }
  void apply(const Twist& command, double duration) override {
    if (duration > 0.0) simulator_.apply(command, duration);
  }
  double time() const override { return simulator_.time(); }

 private:
  Simulator& simulator_;
};

/// Cells whose state differs from what was last recorded.
class MapChanges {
 public:
  std::vector<std::pair<Cell, CellState>> since_last(const GroundMap& ground) {
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
        if (ground.tile_revision(tx, ty) <= revision_) continue;
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

/// Pictures of a run whose length is not known before: at most kMost, at steps that are multiples
/// of a power of two.
class SparsePictures {
 public:
  void add(int step, const CameraPicture& shown) {
    if (shown.image.pixels.empty() || step % every_ != 0) return;
    if (pictures_.size() == kMost) {
      every_ *= 2;
      std::erase_if(pictures_, [&](const LandmarkPicture& p) { return p.frame % every_ != 0; });
      if (step % every_ != 0) return;
    }
    pictures_.push_back(landmark_picture(step, shown.image, shown.sightings, kWidth));
  }
  std::vector<LandmarkPicture> take() { return std::move(pictures_); }

 private:
  static constexpr std::size_t kMost = 300;
  static constexpr int kWidth = 360;  // [px]
  int every_ = 1;
  std::vector<LandmarkPicture> pictures_;
};

/// At most kMost pictures of the cost-to-go, evenly spread, of a run whose length is not known
/// before: at steps that are multiples of a power of two.
class SparseCostsToGo {
 public:
  void add(std::vector<StepRecord>& steps, StepRecord& now, const CostToGo& cost_to_go) {
    if (now.step % every_ != 0) return;
    if (count_ == kMost) {
      every_ *= 2;
      for (StepRecord& step : steps) {
        if (step.cost_to_go && step.step % every_ != 0) {
          step.cost_to_go.reset();
          --count_;
        }
      }
      if (now.step % every_ != 0) return;
    }
    ++count_;
    now.cost_to_go = picture(cost_to_go);
  }

 private:
  static constexpr int kMost = 150;
  static constexpr int kCoarser = 2;

  /// Every other cell; those that were not reached say nothing.
  static CostToGoPicture picture(const CostToGo& cost_to_go) {
    const GridFrame& fine = cost_to_go.frame();
    CostToGoPicture coarse;
    coarse.frame = frame_of_blocks(fine, kCoarser);
    for (int k = 0; k < coarse.frame.size(); ++k) {
      const Eigen::Vector2d center = coarse.frame.center(coarse.frame.at(k));
      const Cell c = fine.cell(center.x(), center.y());
      coarse.seconds.push_back(cost_to_go.reached(c) ? static_cast<float>(cost_to_go.cells()[c])
                                                     : std::numeric_limits<float>::quiet_NaN());
    }
    return coarse;
  }

  int every_ = 1;
  int count_ = 0;
};

/// Plans in full (horizon, candidates, landmarks) of at most kMost steps, evenly spread, so that a
/// mission of hours needs no more memory for them than one of minutes: as SparseCostsToGo.
class SparsePlans {
 public:
  void add(std::vector<StepRecord>& steps, StepRecord& now) {
    if (now.step % every_ == 0 && count_ == kMost) {
      every_ *= 2;
      for (StepRecord& step : steps) {
        if (step.step % every_ == 0 || step.step % (every_ / 2) != 0) continue;
        forget(step);
        --count_;
      }
    }
    if (now.step % every_ != 0) return forget(now);
    ++count_;
  }

 private:
  static constexpr int kMost = 4000;

  static void forget(StepRecord& step) {
    step.horizon = {};
    step.candidates = {};
    step.landmarks = {};
  }

  int every_ = 1;
  int count_ = 0;
};

std::vector<CandidateRecord> candidate_records(const Plan& plan, const Problem* problem,
                                               const MotionModel& model) {
  std::vector<CandidateRecord> records;
  for (const PlanCandidate& c : plan.candidates) {
    CandidateRecord record{c.name, c.polished, c.verdict, {}, {}};
    record.explanation.cost = c.cost;
    record.explanation.violation = c.violation;
    if (problem != nullptr) {
      record.explanation = c.verdict == "executed" ? plan.explanation : problem->explain(c.z);
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

std::shared_ptr<const octomap::OcTree> map_to_begin_with(const Configuration& configuration) {
  std::shared_ptr<const octomap::OcTree> map = read_octree(configuration.map);
  const double resolution = configuration.simulator.mapping.resolution;
  if (map->getResolution() != resolution) {
    throw InputError(configuration.map + ": resolution is " + exact_text(map->getResolution()) +
                     " m; expected " + exact_text(resolution) + " m, simulator.map_resolution");
  }
  return map;
}

std::unique_ptr<Replanner> planner_for(const Configuration& configuration,
                                       const ExplorationRunOptions& options) {
  if (options.make_planner) return options.make_planner(configuration);
  const SolverRegistry builtin;
  const SolverRegistry& solvers = options.solvers ? *options.solvers : builtin;
  return std::make_unique<Planner>(configuration.robot, configuration.planner,
                                   solvers.make(configuration.solver));
}

/// The streams of a simulated robot that stands, as they come for a little longer than they must
/// have been live.
std::vector<PreflightFacts::Stream> watched_streams(SimulatedBase& base, const Clock& clock,
                                                    const Guard::Options& limits) {
  const double begin = clock.now(), end = begin + 1.1 * PreflightOptions().live_time;
  std::vector<PreflightFacts::Stream> streams = {{"cameras", 0.0, limits.max_pose_age},
                                                 {"depth", 0.0, limits.max_ranges_age}};
  std::array<double, 2> live_since = {begin, begin};
  while (clock.now() < end) {
    const std::shared_ptr<const Belief> belief = base.update({});
    if (!belief) continue;
    const double now = clock.now();
    const std::array<double, 2> stamps = {belief->stamps.pose, belief->stamps.ranges};
    for (std::size_t k = 0; k < streams.size(); ++k) {
      streams[k].age = now - stamps[k];
      if (!(streams[k].age <= streams[k].limit)) live_since[k] = now;
      streams[k].live_for = now - live_since[k];
    }
  }
  return streams;
}

/// What is known of the simulated robot before its first motion.
PreflightFacts preflight_facts(const Configuration& c, SimulatedBase& base, const Clock& clock,
                               const Guard::Options& limits_of_age, const RealTimeOptions& driver) {
  PreflightFacts facts;
  facts.body = c.robot.slice();
  facts.resolution = c.simulator.mapping.resolution;
  facts.streams = watched_streams(base, clock, limits_of_age);
  facts.clocks = {{"simulator", 0.0, 0}};  // it is the runtime's
  facts.dead_man = base.dead_man();
  facts.longest_thread_limit =
      std::max({driver.perception_limit, driver.planner_limit, driver.command_limit});
  const BaseLimits limits = base.limits();
  facts.speed = {limits.speed, c.robot.model->max_speed()};
  facts.yaw_rate = {limits.yaw_rate, c.robot.model->max_yaw_rate()};
  facts.deceleration = {limits.acceleration, c.robot.model->max_deceleration()};
  return facts;
}

/// What faults make of scans, up to the sensor's range [m]. Throws std::invalid_argument for
/// sensors that cannot do it.
std::function<void(double, DepthScan&)> scan_faults(const SimulatorOptions& simulator,
                                                    const std::vector<InjectedFault>& faults,
                                                    double range, std::uint64_t seed) {
  constexpr double kNearest = 0.3;  // [m]
  auto distort = faulty_scans(faults, kNearest, range, seed);
  if (distort && simulator.sensors == Sensors::kCamera) {
    throw std::invalid_argument(
        "--fault: depth:garbage and depth:wrong; expected another fault with sensors that are "
        "cameras, or simulator.sensors: model");
  }
  return distort;
}

}  // namespace

ReachableArea reachable_area(const World& world, const Configuration& c) {
  ReachableAreaOptions options;
  options.slice = world_options_for(c).slice;
  const TraversabilityOptions passable =
      frontier_planner_options_for(c.robot, c.planner).traversability;
  options.room =
      passable.hard_radius - circumscribed_radius(c.robot.shape) - passable.lattice_slack;
  options.free_moves = passable.free_moves;
  options.range = c.robot.depth.max_range;
  options.sensor_height = c.robot.base_height() + c.robot.depth_mount.T_BC.translation().z();
  options.map_resolution = c.simulator.mapping.resolution;
  return reachable_area(world, options);
}

Grid<std::uint8_t> roomy_columns(const World& world, const Configuration& c) {
  const Grid<std::uint8_t> standing = standing_columns(world.voxels, world_options_for(c).slice);
  const Eigen::Vector3d& start = world.start.position;
  return connected_component(standing, standing.frame.cell(start.x(), start.y()));
}

ReachableArea told_area(ReachableArea reachable, const Configuration& c) {
  const std::optional<Polygon>& area = c.planner.task.area;
  if (!area && c.planner.zones.empty()) return reachable;
  const ZoneMap zones(c.planner.zones);
  const GridFrame& frame = reachable.cells.frame;
  int kept = 0;
  for (int n = 0; n < frame.size(); ++n) {
    std::uint8_t& cell = reachable.cells.data[static_cast<std::size_t>(n)];
    const Eigen::Vector2d center = frame.center(frame.at(n));
    if ((area && !contains(*area, center)) || zones.distance(center) <= 0.0) cell = 0;
    kept += cell != 0;
  }
  reachable.area = kept * frame.resolution * frame.resolution;
  return reachable;
}

WorldOptions world_options_for(const Configuration& c) {
  const VerticalExtent slice = c.robot.slice();
  WorldOptions options = c.world;
  options.slice.z_min = slice.z_min;
  options.slice.z_max = slice.z_max;
  options.slice.standing_clearance =
      circumscribed_radius(c.robot.shape) + c.simulator.mapping.resolution;
  options.slice.shape = c.robot.shape;
  return options;
}

ExplorationRunResult run_exploration(const std::shared_ptr<const World>& world,
                                     const Configuration& configuration,
                                     const ExplorationRunOptions& options) {
  const auto wall_start = std::chrono::steady_clock::now();
  if (configuration.robot.model && configuration.robot.model->pose_layout().pz >= 0) {
    throw std::invalid_argument("robot.model is '" +
                                std::string(configuration.robot.model->name()) +
                                "', which flies; expected a model that drives, as frontiers and "
                                "the simulator are planar");
  }
  const std::unique_ptr<Replanner> planner = planner_for(configuration, options);
  const Planner* own_planner = dynamic_cast<const Planner*>(planner.get());
  const ReachableArea reachable = told_area(reachable_area(*world, configuration), configuration);

  SimulatorOptions simulator_options = configuration.simulator;
  simulator_options.seed = options.seed;
  if (options.real_time) {
    simulator_options.distort_scan = scan_faults(simulator_options, options.real_time->base.faults,
                                                 configuration.robot.depth.max_range, options.seed);
  }
  if (!configuration.map.empty()) simulator_options.map = map_to_begin_with(configuration);
  Simulator simulator(world, simulator_options);
  simulator.set_reachable(reachable.cells);
  SimulatedRobot robot(simulator);

  // A sensor that delivers seldom is not dead: two of its periods may pass.
  Guard::Options limits = configuration.guard;
  const auto at_least = [](double& limit, double rate) { limit = std::max(limit, 2.0 / rate); };
  at_least(limits.max_map_age, simulator_options.depth_rate);
  at_least(limits.max_ranges_age, simulator_options.depth_rate);
  at_least(limits.max_pose_age, simulator_options.image_rate);
  at_least(limits.max_landmarks_age, simulator_options.image_rate);
  const Guard guard = guard_for(configuration.robot, configuration.planner, limits);

  ExplorationRunResult result;
  RunRecord& record = result.record;
  record.resolution = configuration.simulator.mapping.resolution;
  record.robot_radius = circumscribed_radius(configuration.robot.shape);
  record.sensor_range = configuration.robot.depth.max_range;
  record.sensor_fov = configuration.robot.depth.horizontal_fov;
  record.configuration = effective_yaml(configuration.entries);
  record.zones = configuration.planner.zones;
  record.area = configuration.planner.task.area;

  MapChanges map_changes;
  SparsePictures pictures;
  SparseCostsToGo costs_to_go;
  SparsePlans plans;
  std::vector<StepRecord> steps;
  const SteadyClock clock;
  std::optional<SimulatedBase> base;  // in real time
  std::optional<FaultyDisk> disk;     // likewise
  const auto observe = [&](const MissionStep& step) {
    const Plan& plan = *step.plan;
    const Belief& belief = *step.belief;
    const SimulatedTruth truth = base ? base->truth() : truth_of(simulator);
    StepRecord r;
    r.step = step.index;
    r.time = step.time;
    r.true_pose = truth.pose;
    r.estimated_pose = belief.pose;
    if (!plan.commands.empty()) r.command = plan.commands.front();
    r.plan_kind = to_string(plan.kind);
    r.task = to_string(plan.task);
    if (plan.goal) {
      r.goal = plan.goal->position;
      r.goal_yaw = plan.goal->yaw;
    }
    r.mode = to_string(plan.mode.kind);
    r.cause = to_string(plan.mode.cause);
    // The first mode holds from the start, whatever a running clock says then.
    r.mode_since = std::max(0.0, step.time - (belief.stamp - plan.mode.since));
    r.caution = to_string(plan.caution);
    r.why = plan.why;
    r.seeds_scored = plan.seeds_scored;
    r.features_weight = plan.features_weight;
    r.seed = plan.seed;
    r.explanation = plan.explanation;
    const auto committed = static_cast<std::size_t>(std::max(0, plan.committed));
    if (committed < plan.visible.size()) r.predicted_features = plan.visible[committed];
    r.tracked_features = belief.tracked_features;
    r.localization = to_string(belief.localization);
    r.coverage = truth.coverage;
    r.area = truth.seen_area;
    r.localization_error = truth.localization_error;
    r.path_length = truth.path_length;
    r.collisions = truth.collisions;
    for (const TermValue& term : plan.explanation.terms) {
      if (term.name == "clearance") r.clearance = term.raw + configuration.planner.d_safe;
    }
    r.cost_evaluations = plan.counters.cost_evaluations;
    r.gradient_evaluations = plan.counters.gradient_evaluations;
    r.stop_reason = to_string(plan.stop);
    r.quality = to_string(plan.quality);
    r.certified = plan.certified;
    r.certificate = plan.certified ? plan.certificate : plan.detail;
    r.guard_stops = step.guard_stops;
    if (step.guard_stops > 0) r.guard_reason = to_string(step.guard_reason);
    r.wall = {plan.times.total, plan.times.frontier_planner, plan.times.clearance, plan.times.views,
              plan.times.seeds, plan.times.polish,           plan.times.certify};
    if (step.global_plan) {
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
      r.target_change = to_string(global_plan.facts.changed);
      if (global_plan.target) {
        r.target = TargetRecord{global_plan.target->viewpoint, global_plan.target->looks_at,
                                global_plan.facts.target_length, global_plan.facts.target_area,
                                global_plan.facts.way_left};
      }
      if (options.keep_steps) costs_to_go.add(steps, r, *global_plan.cost_to_go);
    }
    r.candidates = candidate_records(
        plan, own_planner && options.keep_steps ? own_planner->problem().get() : nullptr,
        *configuration.robot.model);
    if (own_planner) {
      const std::vector<Landmark>& landmarks = own_planner->landmarks();
      const Eigen::VectorXd& visibility = own_planner->landmark_visibility();
      for (std::size_t i = 0; i < landmarks.size(); ++i) {
        r.landmarks.push_back({static_cast<float>(landmarks[i].position.x()),
                               static_cast<float>(landmarks[i].position.y()),
                               static_cast<float>(visibility[static_cast<Eigen::Index>(i)])});
      }
    }
    r.map_changes = map_changes.since_last(*belief.ground);
    if (options.keep_steps) pictures.add(r.step, truth.picture);
    if (disk) disk->write();
    if (options.on_step) options.on_step(r);
    if (options.on_plan && own_planner) options.on_plan(r, *own_planner);
    if (!options.keep_steps) {
      r.horizon.clear();
      r.frontier_cells.clear();
      r.landmarks.clear();
      r.map_changes.clear();
      r.candidates.clear();
    } else {
      plans.add(steps, r);
    }
    steps.push_back(std::move(r));
  };

  if (options.on_start) options.on_start();
  MissionOptions mission_options = configuration.mission;
  if (configuration.until_coverage > 0.0 || configuration.until_area > 0.0) {
    mission_options.enough = [&](const MissionStep&) {
      const SimulatedTruth truth = base ? base->truth() : truth_of(simulator);
      return (configuration.until_coverage > 0.0 &&
              truth.coverage >= configuration.until_coverage) ||
             (configuration.until_area > 0.0 && truth.seen_area >= configuration.until_area);
    };
  }
  MissionResult mission;
  if (options.real_time) {
    base.emplace(simulator, clock, *configuration.robot.model, options.real_time->base);
    const std::vector<InjectedFault>& faults = options.real_time->base.faults;
    FaultyReplanner replanner(*planner, *configuration.robot.model, clock, faults, base->start());
    disk.emplace(clock, faults, base->start());
    result.preflight = checks_before_motion(
        preflight_facts(configuration, *base, clock, limits, options.real_time->driver));
    RealTimeDriver driver({.clock = clock,
                           .base = *base,
                           .beliefs = *base,
                           .planner = replanner,
                           .guard = guard,
                           .model = configuration.robot.model,
                           .inbox = &base->sensors(),
                           .failed_preflight = first_failed(result.preflight),
                           // A simulated robot turns as it is told to.
                           .yaw_checked = true},
                          options.real_time->driver);
    mission = driver.run(mission_options, observe, options.cancelled);
    result.driver = driver.status();
    result.events = driver.events().since(0).events;
  } else {
    mission = run_mission(robot, *planner, guard, mission_options, observe, options.cancelled);
  }

  record.summary = summarize(steps);
  Summary& s = record.summary;
  s.world = world->name;
  s.solver = configuration.solver;
  s.seed = options.seed;
  s.task = to_string(configuration.planner.task.kind);
  s.reason = to_string(mission.end);
  s.done = mission.done();
  s.detail = mission.detail;
  s.coverage = simulator.coverage();
  s.area_m2 = simulator.seen_area();
  s.reachable_area_m2 = reachable.area;
  s.too_long_for_m2 = reachable.too_long_for;
  s.collisions = simulator.collisions();
  s.losses = simulator.losses();
  s.duration_s = mission.duration;
  s.path_length_m = simulator.path_length();
  s.fallbacks = mission.fallbacks;
  s.guard_stops = mission.guard_stops;
  s.steps = mission.steps;
  if (configuration.planner.deadline > 0.0) {
    for (const StepRecord& step : steps) {
      s.deadline_misses += step.wall.plan > 1e3 * configuration.planner.deadline;
    }
  }
  if (options.keep_steps) record.steps = std::move(steps);
  record.pictures = pictures.take();
  result.map = simulator.sense()->octree;
  result.complaint = simulator.complaint();
  s.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
  return result;
}

}  // namespace prospect
