#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/maps/belief.h"
#include "engine/planner/replanner.h"
#include "engine/safety/guard.h"
#include "models/motion_model.h"
#include "runtime/base.h"
#include "runtime/belief_source.h"
#include "runtime/clock.h"
#include "runtime/command_following.h"
#include "runtime/command_loop.h"
#include "runtime/drive_mode.h"
#include "runtime/drive_requests.h"
#include "runtime/drive_watch.h"
#include "runtime/emergency_stop.h"
#include "runtime/event_log.h"
#include "runtime/health_report.h"
#include "runtime/latency_histogram.h"
#include "runtime/mission.h"
#include "runtime/range_check.h"
#include "runtime/sensor_inbox.h"
#include "runtime/watched_stream.h"

namespace prospect {

class Knobs;

struct RealTimeOptions {
  CommandLoopOptions command;
  DriveModeOptions mode;
  DriveWatchOptions watch;
  CommandFollowingOptions following;
  double replan_period = 0.25;  ///< [s] from the start of one plan to that of the next
  double least_latency = 0.05;  ///< [s] least and ...
  double most_latency = 0.5;    ///< ... most that a plan is made ahead of its start
  // Longest times between two beats of a thread [s].
  double perception_limit = 1.5;
  double planner_limit = 2.5;
  double command_limit = 0.5;
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, RealTimeOptions& options);

/// What a driver drives with. Everything outlives it; `inbox` and `ranges` may be absent.
struct RobotParts {
  const Clock& clock;
  Base& base;
  BeliefSource& beliefs;
  Replanner& planner;
  const Guard& guard;
  std::shared_ptr<const MotionModel> model;
  SensorInbox* inbox = nullptr;  ///< gets the wheel motion that the base reports
  /// Asked with the command in force and the time, from the command thread (range_check()).
  std::function<RangeCheck(const Twist&, double)> ranges{};
  /// The check before the first motion that failed (preflight.h); empty: all passed.
  std::string failed_preflight = "none was made";
  bool yaw_checked = false;
  /// Who must be able to stop it; null: nobody but who asks by `requests`.
  const EmergencyStopInput* emergency_stop = nullptr;
  // What a health report tells of besides.
  std::vector<WatchedStream> streams{};
  std::vector<CheckResult> preflight{};
  /// What people ask of it, also before it drives; null: nobody but by the driver's own functions.
  DriveRequests* requests = nullptr;
};

/// What has happened so far.
struct DriverStatus {
  DriveState mode;
  std::string why;  ///< describe() of it
  CommandReason reason = CommandReason::kNoPlan;
  std::string detail;                   ///< of the newest command
  LatencyHistogram capture_to_command;  ///< from the newest measurement in a belief to its command
  LatencyHistogram planning;
  LatencyHistogram command_period;  ///< between two commands
  int late_plans = 0;
  int guard_stops = 0;
};

/// A mission on a robot in real time, by three threads that never wait for each other:
///
///   perception  BeliefSource::update() -> newest belief
///   planner     newest belief -> Replanner::prepare(), then predicted belief -> plan, which takes
///               effect at its stamp
///   command     every period: base report -> facts -> drive mode -> command -> base
///
/// The newest of each is handed on by a pointer under a lock that is held for its copy. What is
/// done when something is wrong stands in one table, drive_mode.h; the order in which a command is
/// decided, in command_loop.h. The calling thread waits for the end.
///
/// Latency. With t_k the start of plan k, L how long Replanner::plan() may take (PlanningLatency;
/// prepare() comes before it, while plan k-1 is driven), T the replan_period, C = committed dt, and
/// B the time that the stop takes:
///
///     t_k - L      t_k                  t_k + T             t_k + C      t_k + C + B
///        |----------|---------------------|-------------------|------------|
///        plan k is  plan k in force       plan k+1 in force,  plan k's     at rest
///        made                             if it is on time    stop
///
///   * Plan k starts from the pose and velocity at t_k, as predicted from the newest belief through
///     the commands that were sent and those of plan k-1 up to t_k (predicted_belief.h).
///   * Certified is the motion over [t_k, t_k + C] and the stop after it. So it covers the time
///     until plan k+1 can take over, if C >= max(T, L), and the stop if it does not.
///   * Nothing is assumed of a step's time for safety. A plan that is late is not driven; the
///     command thread is on the stop of the plan before, which was certified with it, and then at
///     rest; the next plan starts from there.
///   * At each command the guard certifies, on the newest map and from the predicted pose, that the
///     command is held until it expires, and the hardest braking after it. What a map has learned
///     since the plan was made counts from the next command on.
///   * If the command thread itself stops, the base goes on for no longer than its dead-man's time,
///     and brakes: up to (dead_man) v + v^2 / (2 a) that no certificate covers.
///
/// What it says by itself, in the events: each change of the drive mode, each refusal of the guard,
/// late plans; why the robot stands when it is told to drive and has been at rest for 10 s; and,
/// from the thread that called run(), that the command thread does not answer.
///
/// It ends as run_mission() does: the task is over, enough is seen, the time limit, localization
/// lost for too long, or cancelled; then the robot brakes, and all threads are joined. An emergency
/// stop or a fault of the base does not end it: it latches until it is acknowledged.
///
/// Thread-safety: run() once, by one thread; the other functions by any. Errors: the constructor
/// throws std::invalid_argument for a base that declares no dead-man, and for options out of range;
/// run() passes on what on_step() or MissionOptions::missing throw, once the robot is at rest.
class RealTimeDriver {
 public:
  RealTimeDriver(const RobotParts& parts, const RealTimeOptions& options);
  ~RealTimeDriver();

  /// Observers are told as mission_observer.h says. MissionStep::belief is the newest when the step
  /// began; the plan begins at its stamp, later. result.duration is of the runtime's clock.
  MissionResult run(const MissionOptions& mission);

  // As DriveRequests.
  void emergency_stop() noexcept;
  void acknowledge() noexcept;
  void hold() noexcept;
  void resume() noexcept;

  DriverStatus status() const;
  /// How the robot is, with its last ten events of warnings or worse.
  HealthReport health() const;
  const EventLog& events() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
