// A robot of one's own: a 2-D lidar, a localization that needs no camera, an OctoMap that grows
// while the robot drives, and a planner in a thread of its own.
#include <octomap/OcTree.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "engine/maps/map_projection.h"
#include "engine/planner/planner.h"
#include "engine/safety/guard.h"
#include "models/make_model.h"
#include "pretend_robot.h"
#include "solvers/registry.h"

prospect::RobotDescription my_robot() {
  prospect::RobotDescription robot;
  // How it moves: a base with two driven wheels that may also reverse slowly.
  robot.model = prospect::make_model("unicycle", {{"v_min", -0.1},       // [m/s]
                                                  {"v_max", 0.5},        // [m/s]
                                                  {"omega_max", 1.0},    // [rad/s]
                                                  {"a_max", 0.8},        // [m/s^2]
                                                  {"alpha_max", 2.5}});  // [rad/s^2]
  // Its body in frame B: x forward, y left, z up; B's origin is on the floor, between the wheels.
  robot.shape = prospect::CylinderShape{.center = {0, 0, 0.25}, .radius = 0.2, .height = 0.4};
  // What sees new space: a lidar of one layer, all round, 0.3 m above the floor.
  robot.depth.horizontal_fov = 2.0 * M_PI;
  robot.depth.vertical_fov = 0.0;
  robot.depth.min_range = 0.1;
  robot.depth.max_range = 5.0;
  robot.depth_mount.T_BC = prospect::CameraMount::forward_facing({0.0, 0.0, 0.3});
  return robot;
}

// Enters a turn of the lidar into the map. A ray without an echo clears as far as the range.
void add_scan(const std::vector<double>& ranges, const prospect::Pose& pose,
              const prospect::RobotDescription& robot, octomap::OcTree& tree) {
  const double height = robot.base_height() + robot.depth_mount.T_BC.translation().z();
  const octomap::point3d origin(static_cast<float>(pose.position.x()),
                                static_cast<float>(pose.position.y()), static_cast<float>(height));
  octomap::Pointcloud points;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle = pose.yaw + 2.0 * M_PI * static_cast<double>(i) / 720.0;
    const double range = std::min(ranges[i], 2.0 * robot.depth.max_range);
    points.push_back(origin.x() + static_cast<float>(range * std::cos(angle)),
                     origin.y() + static_cast<float>(range * std::sin(angle)), origin.z());
  }
  tree.insertPointCloud(points, origin, robot.depth.max_range);
}

// What the planner is to know: the pose, the command in force, and the maps, made from a copy of
// the tree, so that the tree may grow while the planner works.
prospect::Belief belief_at(double stamp, const prospect::Pose& pose, const prospect::Twist& command,
                           const prospect::RobotDescription& robot, const octomap::OcTree& tree) {
  prospect::Belief belief;
  belief.localization_source = prospect::LocalizationSource::kExternal;  // features cost nothing
  belief.set_stamps(stamp);
  belief.pose = pose;
  belief.twist = command;
  belief.command = command;
  const double top = robot.slice().z_max + 0.1;
  const prospect::BeliefMaps maps =
      prospect::belief_maps(std::make_shared<octomap::OcTree>(tree), height_slice(robot), 0.0, top);
  belief.octree = maps.octree, belief.voxels = maps.voxels, belief.ground = maps.ground;
  return belief;
}

// The belief that will hold once `command` has been driven for `duration`: where the next plan
// begins. So the time that planning takes is no delay.
prospect::Belief ahead(prospect::Belief belief, const prospect::Twist& command, double duration,
                       const prospect::MotionModel& model) {
  Eigen::VectorXd next(model.nx());
  model.step(model.state(belief.pose, command), model.input(command), duration, next);
  belief.pose = model.pose(next);
  belief.twist = command;
  belief.command = command;
  belief.set_stamps(belief.stamp + duration);
  return belief;
}

// Plans in a thread of its own: takes the newest belief that it was given, leaves the newest plan.
class PlannerThread {
 public:
  struct Planned {
    prospect::Plan plan;
    double known = 0.0;  // ground that the planner knows of [m2]
  };

  explicit PlannerThread(prospect::Planner& planner)
      : planner_(planner), thread_([this] { run(); }) {}
  ~PlannerThread() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  void ask(prospect::Belief belief) {
    {
      const std::lock_guard lock(mutex_);
      asked_ = std::move(belief);
    }
    wake_.notify_one();
  }
  std::optional<Planned> newest() const {
    const std::lock_guard lock(mutex_);
    return planned_;
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      wake_.wait(lock, [this] { return over_ || asked_; });
      if (over_) return;
      const prospect::Belief belief = std::move(*asked_);
      asked_.reset();
      lock.unlock();
      Planned planned{planner_.plan(belief)};  // never throws
      if (const auto made = planner_.global_plan()) planned.known = made->explored_area;
      lock.lock();
      planned_ = std::move(planned);
    }
  }

  prospect::Planner& planner_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<prospect::Belief> asked_;
  std::optional<Planned> planned_;
  bool over_ = false;
  std::thread thread_;  // the last member: it begins once the others are there
};

int main() {
  const prospect::RobotDescription robot = my_robot();
  prospect::PlannerParameters parameters;
  parameters.dt = 0.25;         // a stage [s]: how long a command is held
  parameters.N = 20;            // stages: a plan looks 5 s ahead
  parameters.committed = 0.75;  // certified [s]: three stages, so the next plan may be two late
  parameters.weights.visible_features = 0.0;  // no camera, so no features to keep in view
  parameters.map_resolution = 0.1;  // of the maps to come [m]: what does not fit is refused now
  prospect::Planner planner(robot, parameters, prospect::make_solver("nlopt"));

  prospect::Guard::Options limits;
  limits.max_landmarks_age = std::numeric_limits<double>::infinity();  // there are none
  const prospect::Guard guard = planner.make_guard(limits);

  PretendRobot base;
  octomap::OcTree tree(0.1);
  prospect::Twist command;  // in force
  double known = 0.0;
  int late = 0, braked = 0;
  bool touched = false;
  PlannerThread planning(planner);

  for (int step = 0; step < 120; ++step) {
    // What is.
    const double now = base.now();
    const prospect::Pose pose = base.pose();
    add_scan(base.scan(pose, robot.depth.max_range), pose, robot, tree);
    const prospect::Belief belief = belief_at(now, pose, command, robot, tree);

    // What to do now. Stage k of a plan is for the time from plan.stamp + k dt on. Nothing reaches
    // the motors unchecked; without a plan the robot stands.
    const std::optional<PlannerThread::Planned> planned = planning.newest();
    prospect::GuardVerdict verdict;
    if (planned) {
      const prospect::Plan& plan = planned->plan;
      const int stage = static_cast<int>((now - plan.stamp) / plan.dt);
      verdict = guard.check(plan, stage, command, belief, now);
      known = planned->known;
      late += stage > 0;
      braked += !verdict.passed();
      if (plan.mode.kind == prospect::ModeKind::kDone) break;
    }
    command = verdict.command;
    base.drive(command);

    // What comes next: a plan that begins when this command ends, from where the robot is then.
    const double next = (step + 1) * parameters.dt;
    planning.ask(ahead(belief, command, next - now, *robot.model));

    touched = touched || base.touches(0.2);
    std::printf("%5.2f s (%.2f, %.2f) %.2f m/s %+.2f rad/s, %.1f m2; guard %s; %s\n", now,
                pose.position.x(), pose.position.y(), command.linear.x(), command.yaw_rate, known,
                to_string(verdict.reason).data(),
                planned ? planned->plan.why.c_str() : "no plan yet");
    std::this_thread::sleep_for(std::chrono::duration<double>(next - base.now()));
  }
  base.drive(prospect::Twist());
  std::printf("knows %.1f m2; late plans: %d; commands replaced by the guard: %d; %s a wall\n",
              known, late, braked, touched ? "touched" : "did not touch");
  return touched ? 1 : 0;
}
