// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
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
#include "runtime/preflight.h"
#include "runtime/range_check.h"
#include "runtime/sensor_inbox.h"
#include "runtime/watched_stream.h"

namespace prospect {

class Knobs;

struct DriverOptions {
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
  /// By which run() and the checks before it send commands (realtime_priority.h); 0: as all else.
  int priority = 10;
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, DriverOptions& options);

/// What a driver, and the checks before it, work with. Everything outlives it.
struct DriverParts {
  const Clock& clock;
  const Guard& guard;
  std::shared_ptr<const MotionModel> model;
  /// [s] after which the base stops by itself when commands cease (base.h); none: it is refused.
  std::optional<double> dead_man{};
  /// Gets the wheel motion that the base reports, and has what an IMU measures.
  SensorInbox* inbox = nullptr;
  /// The pose of a belief is its wheels': no witness besides them of how the base moves.
  bool pose_of_wheels = false;
  /// Asked with the command in force and the time, from the command thread (range_check()).
  std::function<RangeCheck(const Twist&, double)> ranges{};
  /// Who must be able to stop it; null: nobody but who asks by `requests`.
  const EmergencyStopInput* emergency_stop = nullptr;
  /// Those that the robot needs: pre-flight waits for them, and a health report tells of them.
  std::vector<WatchedStream> streams{};
  /// What people ask of it, also before it drives; null: nobody but by Driver::requests().
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

/// A robot's mission in real time, as five calls:
///
///   observe()  perceives: what is known now -> newest belief
///   advance()  plans:     newest belief -> Replanner::prepare(), then predicted belief -> plan,
///                         which takes effect at its stamp
///   command()  commands:  what the base reports -> facts -> drive mode -> what it is to be told
///   events()   tells what has happened
///   stop()     ends it: the robot brakes
///
/// The first three are called by a thread each, again and again, and never wait for each other: the
/// newest of each is handed on by a pointer under a lock that is held for its copy. Who does not
/// call in time (perception_limit, planner_limit, command_limit) is late, and the robot stops.
/// run() calls them by three threads of its own. What is done when something is wrong stands in one
/// table, drive_mode.h; the order in which a command is decided, in command_loop.h.
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
/// late plans; why the robot stands when it is told to drive and has been at rest for 10 s; and, by
/// watch(), that the command thread does not answer.
///
/// It ends as run_mission() does: the task is over, enough is seen, the time limit, localization
/// lost for too long, or cancelled; then the robot brakes. An emergency stop or a fault of the base
/// does not end it: it latches until it is acknowledged.
///
/// Thread-safety: observe(), advance() and command() by one thread each, watch() and finish() by
/// one; the others by any. Errors: the constructor throws std::invalid_argument without a model,
/// for a base that declares no dead-man, and for options out of range; finish() passes on what
/// on_step() or MissionOptions::missing threw, which ends the mission.
class Driver {
 public:
  /// preflight: what came of the checks before the first motion (run_preflight()): it does not
  /// drive if one has failed, and slowly if none has seen it turn. None: no check was made, and it
  /// does not drive. planner outlives it.
  Driver(const DriverParts& parts, Replanner& planner,
         const std::optional<PreflightResult>& preflight, const DriverOptions& options = {},
         const MissionOptions& mission = {});
  ~Driver();

  /// Takes what is known now, its stamps in the clock's time; null: nothing new has come. picture:
  /// what the cameras showed for it.
  void observe(std::shared_ptr<const Belief> newest, const CameraPicture& picture = {});
  /// Waits until the next plan is due, and makes it. False: the mission is over, or `stop` was
  /// requested. Observers are told as mission_observer.h says: MissionStep::belief is the newest
  /// when the step began; the plan begins at its stamp, later.
  bool advance(const std::stop_token& stop = {});
  /// What the base is to be told now: at each DriverOptions::command.period, also after the
  /// mission is over, until at_rest().
  CommandStep command(const BaseReport& report);
  const EventLog& events() const;
  void stop() noexcept;  ///< the mission ends as cancelled

  /// Whether the mission is over and the robot has come to rest.
  bool at_rest() const noexcept;
  DriveRequests& requests();
  DriverStatus status() const;
  /// How the robot is, with its last ten events of warnings or worse.
  HealthReport health() const;

  /// Some times a second, by who waits for the end: looks whether commands are sent, and tells
  /// observers of events and health.
  void watch();
  /// At the end, once, when no thread calls any more: tells observers of it. result.duration is of
  /// the clock.
  MissionResult finish();

  /// All of it, once, by three threads, until the robot is at rest: finish(). base and beliefs
  /// belong to them meanwhile.
  MissionResult run(Base& base, BeliefSource& beliefs);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
