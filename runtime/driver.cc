// SPDX-License-Identifier: Apache-2.0
#include "runtime/driver.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "engine/maps/correction.h"
#include "models/knobs.h"
#include "models/limited_twist.h"
#include "runtime/mission_progress.h"
#include "runtime/planning_latency.h"
#include "runtime/predicted_belief.h"
#include "runtime/realtime_priority.h"
#include "runtime/supervisor.h"

namespace prospect {
namespace {

enum SupervisedIndex { kPerception, kPlanner, kCommand };

constexpr double kPoll = 0.02;         // [s] in which who waits for the end looks
constexpr double kLongestStop = 10.0;  // [s] after which a base that does not stop is left alone

std::vector<SupervisedThread> threads_of(const DriverOptions& o) {
  return {{"perception", o.perception_limit},
          {"planner", o.planner_limit},
          {"command", o.command_limit}};
}

const DriverParts& checked(const DriverParts& parts) {
  if (!parts.model) throw std::invalid_argument("driver: no motion model; expected one");
  if (!parts.dead_man || !(*parts.dead_man > 0.0)) {
    throw std::invalid_argument(
        "driver: the base declares no dead-man; expected one that stops by itself when commands "
        "cease, or a relay beside it that does");
  }
  return parts;
}

const DriverOptions& checked(const DriverOptions& options) {
  check_knobs("driver", options);
  return options;
}

/// The newest of something, handed from one thread to others.
template <typename Value>
class Newest {
 public:
  void set(Value value) {
    const std::lock_guard lock(mutex_);
    value_ = std::move(value);
  }
  Value get() const {
    const std::lock_guard lock(mutex_);
    return value_;
  }

 private:
  mutable std::mutex mutex_;
  Value value_{};
};

struct NewestPlan {
  std::shared_ptr<const Plan> plan;
  std::optional<double> from_rest;  // stamp of the newest one that starts at rest
};

/// [s] until the stop of a plan ends.
double time_left(const Plan* plan, double now) {
  if (!plan) return 0.0;
  return plan->stamp + (plan->committed + static_cast<double>(plan->tail.size())) * plan->dt - now;
}

/// Tells what of an inbox has jumped since it was asked the last time.
class StreamJumps {
 public:
  /// How the pose from outside has; empty: it has not.
  std::string pose(const SensorInbox* inbox) {
    if (!inbox) return {};
    const StreamCount count = inbox->count(SensorStream::kPose);
    return std::exchange(poses_, count.pose_jumps) < count.pose_jumps ? count.pose_jump : "";
  }
  /// Name of a stream whose clock has; empty: none has.
  std::string clock(const SensorInbox* inbox) {
    std::string jumped;
    for (std::size_t k = 0; inbox && k < kSensorStreams; ++k) {
      const auto stream = static_cast<SensorStream>(k);
      const int jumps = inbox->count(stream).jumps;
      if (jumps > seen_[k]) jumped = to_string(stream);
      seen_[k] = jumps;
    }
    for (std::size_t n = 1; inbox && n < sensors_.size(); ++n) {
      const auto sensor = static_cast<int>(n);
      const int jumps = inbox->count_of_sensor(sensor).jumps;
      if (jumps > sensors_[n]) jumped = sensor_name(sensor);
      sensors_[n] = jumps;
    }
    return jumped;
  }

 private:
  std::array<int, kSensorStreams> seen_{};
  std::array<int, kMostDepthSensors> sensors_{};
  int poses_ = 0;
};

/// What an IMU has measured since it was asked the last time.
class NewImu {
 public:
  std::vector<ImuSample> of(const SensorInbox* inbox) {
    std::vector<ImuSample> samples;
    if (inbox) samples = inbox->imu_since(until_);
    if (!samples.empty()) until_ = samples.back().stamp;
    return samples;
  }

 private:
  double until_ = -std::numeric_limits<double>::infinity();  // [s]
};

/// Tells of a robot that is told to drive and stands.
class Standstill {
 public:
  explicit Standstill(double now) : moved_(now) {}
  /// Whether it has stood for so long, once each time.
  bool is_long(double now, bool stands) {
    constexpr double kLong = 10.0;  // [s]
    if (!stands) {
      moved_ = now;
      told_ = false;
    }
    return now - moved_ >= kLong && !std::exchange(told_, true);
  }

 private:
  double moved_;  // [s] when it last did
  bool told_ = false;
};

}  // namespace

struct Driver::Impl {
  const DriverParts parts;
  const DriverOptions options;
  const MissionOptions mission;
  const std::optional<PreflightResult> preflight;
  const std::string failed_preflight;
  EventLog events;
  Supervisor supervisor;
  DriveRequests own_requests;
  DriveRequests& requests;

  // Handed from one thread to others.
  Newest<std::shared_ptr<const Belief>> belief;
  Newest<NewestPlan> plan;
  Newest<CommandState> command;
  Newest<DriverStatus> status;
  Newest<LatencyHistogram> planning_seen;
  std::atomic<bool> cancelled{false}, over{false};
  std::atomic<bool> at_rest{false};  // after `over`
  std::atomic<int> guard_stops{0};   // since the last planning step
  std::atomic<GuardReason> guard_reason{GuardReason::kPassed};

  // Of the thread that perceives.
  int corrected = 0, not_corrected = 0;

  // Of the thread that plans.
  MissionProgress progress;
  PlanningLatency latency, preparation;
  double start = -std::numeric_limits<double>::infinity();  // [s] of the newest plan
  NewestPlan published;
  LatencyHistogram planning;
  std::exception_ptr thrown;  // by an observer, read at the end

  // Of the thread that commands.
  CommandLoop loop;
  DriveWatch watch;
  CommandFollowing following;
  DriveState mode;
  DriverStatus seen;
  StreamJumps jumps;
  NewImu imu;
  Standstill standstill;
  double before;  // [s] of the command before

  // Of the thread that waits for the end.
  std::uint64_t next_event = 0;                                // of those that it told of
  double reported = -std::numeric_limits<double>::infinity();  // [s]
  bool late = false;                                           // the command thread

  Impl(const DriverParts& p, Replanner& planner, const std::optional<PreflightResult>& checks,
       const DriverOptions& o, const MissionOptions& m)
      : parts(checked(p)),
        options(checked(o)),
        mission(m),
        preflight(checks),
        failed_preflight(checks ? first_failed(checks->checks) : "none was made"),
        supervisor(threads_of(o), p.clock.now()),
        requests(p.requests ? *p.requests : own_requests),
        progress(mission, planner, p.clock.now()),
        latency(o.least_latency, o.most_latency, 2.0 * o.command.period),
        preparation(0.0, o.most_latency, 0.0),
        loop(p.model, p.guard, o.command),
        watch(o.watch),
        following(o.following, o.command.delay),
        standstill(p.clock.now()),
        before(p.clock.now()) {
    mode.since = before;
  }

  double now() const { return parts.clock.now(); }
  bool is_cancelled() const { return cancelled || (mission.cancelled && mission.cancelled()); }
  /// Corrections of the map since the belief before; null: there are none.
  void note_corrections(const MapFrame* frame);
  /// Of the streams that the robot needs one that no belief tells of, and that is too old; empty.
  std::string stale_stream(double instant) const;
  /// A planning step; false: the mission is over.
  bool plan_next(const std::stop_token& stop);
  /// Waits, going on with what the deadline left unfinished. False: it is to stop.
  bool wait_and_go_on(double until, const std::stop_token& stop);
  DriveObservation look(const BaseReport& report, const Belief* newest, const RangeCheck& ranges,
                        double instant);
  void decide_mode(const DriveFacts& facts);
  /// Notes in status and events what a command was; the belief and the plan may be null.
  void note(const CommandStep& step, const DriveFacts& facts, const Belief* newest,
            const Plan* newest_plan);
};

void Driver::observe(std::shared_ptr<const Belief> newest, const CameraPicture& picture) {
  Impl& s = *impl_;
  s.supervisor.beat(kPerception, s.now());
  if (!newest) return;
  s.note_corrections(newest->map_frame.get());
  if (picture.image) tell(s.mission.observers, &MissionObserver::on_picture, picture);
  tell(s.mission.observers, &MissionObserver::on_belief, *newest);
  s.belief.set(std::move(newest));
}

void Driver::Impl::note_corrections(const MapFrame* frame) {
  if (frame == nullptr) return;
  const int refused = frame->refused + frame->cannot_follow;
  if (std::exchange(corrected, frame->taken) < frame->taken && frame->newest) {
    events.add(now(), Severity::kInfo, "map", "correction", to_text(*frame->newest));
  }
  if (std::exchange(not_corrected, refused) < refused) {
    events.add(now(), Severity::kWarning, "map", "correction refused", frame->refusal);
  }
}

bool Driver::advance(const std::stop_token& stop) {
  Impl& s = *impl_;
  s.supervisor.beat(kPlanner, s.now());
  if (s.over) return false;
  try {
    if (s.plan_next(stop)) return !stop.stop_requested();
  } catch (...) {
    s.thrown = std::current_exception();
  }
  s.over = true;
  return false;
}

bool Driver::Impl::wait_and_go_on(double until, const std::stop_token& stop) {
  while (until - now() > kPoll && !stop.stop_requested()) {
    supervisor.beat(kPlanner, now());
    if (!progress.go_on(kPoll)) break;
  }
  return parts.clock.wait_until(until, stop);
}

bool Driver::Impl::plan_next(const std::stop_token& stop) {
  std::shared_ptr<const Belief> newest = belief.get();
  if (!newest) {
    Belief nothing;
    nothing.localization = Localization::kLost;
    if (progress.over_before(nothing, now(), is_cancelled())) return false;
    parts.clock.wait_until(now() + kPoll, stop);
    return true;
  }
  // Not before the plan before has begun: its successor is predicted through it.
  const double lead = latency.value(), ahead = preparation.value();
  start = std::max(now() + ahead + lead, start + std::max(options.replan_period, ahead + lead));
  if (!wait_and_go_on(start - lead - ahead, stop)) return true;
  const double prepared = now();
  progress.prepare(*belief.get());
  preparation.add(now() - prepared);
  start = std::max(start, now() + lead);
  if (!wait_and_go_on(start - lead, stop)) return true;
  newest = belief.get();
  const double begun = now();
  if (progress.over_before(*newest, begun, is_cancelled())) return false;
  progress.take_detour(requests);
  const std::vector<SentCommand> commands =
      commands_until(*parts.model, command.get(), begun, start, options.command.period);
  const Belief predicted = predicted_belief(*newest, commands, start, options.command.delay);
  published.plan = progress.plan(*newest, predicted, begun);
  if (!published.plan) return false;
  if (is_at_rest(predicted.twist)) published.from_rest = predicted.stamp;
  plan.set(published);
  const double took = now() - begun;
  latency.add(took);
  planning.add(took);
  planning_seen.set(planning);

  const GuardStops stops{guard_stops.exchange(0), guard_reason.exchange(GuardReason::kPassed)};
  progress.result.guard_stops += stops.count;
  return !progress.over_after(*newest, *published.plan, stops);
}

std::string Driver::Impl::stale_stream(double instant) const {
  const std::string imu(to_string(SensorStream::kImu));
  for (const WatchedStream& stream : parts.streams) {
    if (stream.source != imu) continue;
    const std::optional<double> stamp = stream.stamp(nullptr);
    if (!stamp || !(instant - *stamp <= stream.limit)) return stream.source;
  }
  return {};
}

DriveObservation Driver::Impl::look(const BaseReport& report, const Belief* newest,
                                    const RangeCheck& ranges, double instant) {
  DriveObservation observation;
  observation.now = instant;
  observation.belief = newest;
  if (newest) observation.stale_source = parts.guard.stale_source(*newest, instant);
  if (observation.stale_source.empty()) observation.stale_source = stale_stream(instant);
  observation.base = &report;
  observation.threads = supervisor.report(instant);
  observation.obstacle = ranges.obstacle;
  observation.jumped_clock = jumps.clock(parts.inbox);
  observation.jumped_pose = jumps.pose(parts.inbox);
  observation.told_to_drive = requests.told_to_drive();
  const EmergencyStopState button =
      parts.emergency_stop ? parts.emergency_stop->state(instant) : EmergencyStopState();
  // Requests tell it once: the drive mode latches it.
  observation.emergency_stop = requests.take_emergency_stop() || button.pressed;
  observation.silent_emergency_stop = button.silent;
  if (const auto departure = following.look(
          instant, report, parts.pose_of_wheels ? nullptr : newest, imu.of(parts.inbox))) {
    observation.not_following = to_text(*departure);
  }
  observation.acknowledged = requests.take_acknowledgement();
  observation.task_over = over;
  observation.failed_preflight = failed_preflight;
  observation.yaw_checked = preflight && preflight->yaw_checked;
  return observation;
}

void Driver::Impl::decide_mode(const DriveFacts& facts) {
  const DriveState next = decide(mode, facts, options.mode);
  if (next.mode != mode.mode || next.cause != mode.cause) {
    const bool bad = next.mode == DriveMode::kStopping || next.mode == DriveMode::kStopped;
    events.add(facts.stamp,
               next.mode == DriveMode::kStopped    ? Severity::kFatal
               : bad && !over                      ? Severity::kError
               : next.mode == DriveMode::kDegraded ? Severity::kWarning
                                                   : Severity::kInfo,
               "drive mode", to_string(next.cause), describe(next, facts));
  }
  mode = next;
  requests.set_stopped(mode.mode == DriveMode::kStopped);
}

CommandStep Driver::command(const BaseReport& report) {
  Impl& s = *impl_;
  const DriverParts& parts = s.parts;
  s.supervisor.beat(kCommand, s.now());
  // Who has ended what it did is not late.
  if (s.over) s.supervisor.beat(kPlanner, s.now());
  if (parts.inbox) {
    for (const WheelSample& sample : report.wheels) parts.inbox->wheels(sample);
  }
  const std::shared_ptr<const Belief> newest = s.belief.get();
  const NewestPlan newest_plan = s.plan.get();
  const CommandState state = s.loop.state();
  const double instant = s.now();  // after what was read, so that nothing is from the future
  const RangeCheck ranges = parts.ranges ? parts.ranges(state.command, instant) : RangeCheck();
  DriveObservation observation = s.look(report, newest.get(), ranges, instant);
  observation.sent = state.sent;
  observation.plan_from_rest = newest_plan.from_rest;
  observation.plan_left = time_left(newest_plan.plan.get(), instant);
  const DriveFacts facts = s.watch.facts(observation);
  s.decide_mode(facts);

  const CommandStep step = s.loop.step({instant, newest_plan.plan, newest, report,
                                        drive_speed(s.mode, s.options.mode), ranges.share});
  s.following.told({instant, step.expires, step.command, step.stop});
  tell(s.mission.observers, &MissionObserver::on_command, instant,
       step.stop ? Twist{} : step.command);
  s.command.set(s.loop.state());
  s.at_rest = s.over && facts.rest_for > 0.0 && step.command.linear.isZero(0.0) &&
              step.command.yaw_rate == 0.0;
  s.note(step, facts, newest.get(), newest_plan.plan.get());
  return step;
}

void Driver::Impl::note(const CommandStep& step, const DriveFacts& facts, const Belief* newest,
                        const Plan* newest_plan) {
  const double instant = facts.stamp;
  if (step.reason == CommandReason::kGuard) {
    ++guard_stops;
    guard_reason = step.guard;
    ++seen.guard_stops;
    events.add(instant, Severity::kWarning, "guard", to_string(step.guard), step.detail);
  }
  if (loop.late_plans() > seen.late_plans) {
    events.add(instant, Severity::kWarning, "planner", "late plan",
               "a plan came after its start and is not driven");
  }
  const bool stands = is_at_rest(step.command) || facts.rest_for > 0.0;
  if (standstill.is_long(instant, facts.told_to_drive && !over && stands)) {
    std::string why = describe(mode, facts);
    if (!step.detail.empty()) why += " " + step.detail + ".";
    if (newest_plan) why += " The planner: " + newest_plan->why;
    events.add(instant, Severity::kWarning, "drive", "standstill",
               "stands for 10 s: " + std::string(to_string(step.reason)) + ". " + why);
  }
  seen.mode = mode;
  seen.why = describe(mode, facts);
  seen.reason = step.reason;
  seen.detail = step.detail;
  seen.late_plans = loop.late_plans();
  if (newest) seen.capture_to_command.add(std::max(0.0, now() - newest->stamps.pose));
  seen.command_period.add(instant - before);
  before = instant;
  status.set(seen);
}

void Driver::watch() {
  Impl& s = *impl_;
  const double time = s.now();
  // A command thread that hangs cannot say so itself: the base's dead-man is what is left then.
  const ThreadReport command_thread = s.supervisor.report(time)[kCommand];
  const bool is_late = !at_rest() && command_thread.state != ThreadState::kOnTime &&
                       command_thread.state != ThreadState::kStarting;
  if (is_late && !s.late) {
    s.events.add(
        time, Severity::kError, "supervisor", "thread late",
        "the command thread does not answer: " + std::string(to_string(command_thread.state)) +
            "; the base's dead-man is what stops the robot");
  }
  s.late = is_late;
  for (const RequestNote& note : s.requests.take_notes()) {
    s.events.add(time, note.bad ? Severity::kWarning : Severity::kInfo, "goal",
                 note.bad ? "not reached" : "over", note.text);
  }
  const std::vector<MissionObserver*>& observers = s.mission.observers;
  if (observers.empty()) return;
  const EventLog::Reading reading = s.events.since(s.next_event);
  s.next_event = reading.next;
  if (!reading.events.empty()) {
    tell(observers, &MissionObserver::on_events, std::span<const Event>(reading.events));
  }
  constexpr double kEvery = 0.2;  // [s]
  if (time - s.reported < kEvery) return;
  s.reported = time;
  tell(observers, &MissionObserver::on_status, status(), health());
}

MissionResult Driver::finish() {
  Impl& s = *impl_;
  s.reported = -std::numeric_limits<double>::infinity();
  watch();
  if (s.thrown) std::rethrow_exception(s.thrown);
  tell(s.mission.observers, &MissionObserver::on_end, s.progress.result);
  return s.progress.result;
}

MissionResult Driver::run(Base& base, BeliefSource& beliefs) {
  Impl& s = *impl_;
  const Clock& clock = s.parts.clock;
  const std::vector<MissionObserver*>& observers = s.mission.observers;
  beliefs.watched_by(observers);
  {
    // In the order in which they are needed; the command thread ends last.
    std::jthread command([&](const std::stop_token& stop) {
      const RealtimePriority first(s.options.priority);
      double tick = clock.now();
      while (!stop.stop_requested()) {
        const CommandStep step = this->command(base.report());
        if (step.stop) {
          base.stop();
        } else {
          base.send(step.command, step.expires);
        }
        // A tick that was missed is left out: commands come no faster than the period.
        tick = std::max(tick + s.options.command.period, clock.now());
        clock.wait_until(tick, stop);
      }
    });
    std::jthread planner([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        if (!advance(stop)) clock.wait_until(clock.now() + kPoll, stop);
      }
    });
    std::jthread perception([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        std::shared_ptr<const Belief> newest = beliefs.update(stop);
        const bool shown = newest && !observers.empty();
        observe(std::move(newest), shown ? beliefs.picture() : CameraPicture());
      }
    });
    const auto wait = [&] { clock.wait_until(clock.now() + kPoll, {}); };
    while (!s.over) {
      wait();
      watch();
    }
    for (const double end = clock.now(); !at_rest() && clock.now() - end < kLongestStop;) wait();
  }
  base.stop();
  beliefs.watched_by({});
  return finish();
}

Driver::Driver(const DriverParts& parts, Replanner& planner,
               const std::optional<PreflightResult>& preflight, const DriverOptions& options,
               const MissionOptions& mission)
    : impl_(std::make_unique<Impl>(parts, planner, preflight, options, mission)) {}
Driver::~Driver() = default;

void Driver::stop() noexcept { impl_->cancelled = true; }
bool Driver::at_rest() const noexcept { return impl_->at_rest; }
const EventLog& Driver::events() const { return impl_->events; }
DriveRequests& Driver::requests() { return impl_->requests; }

DriverStatus Driver::status() const {
  DriverStatus status = impl_->status.get();
  status.planning = impl_->planning_seen.get();
  return status;
}
HealthReport Driver::health() const {
  constexpr std::size_t kShown = 10;
  const Impl& s = *impl_;
  const DriverStatus seen = status();
  const std::shared_ptr<const Belief> belief = s.belief.get();
  HealthReport report;
  report.stamp = s.now();
  report.drive = seen.mode;
  report.speed = drive_speed(seen.mode, s.options.mode);
  report.why = seen.why;
  for (const WatchedStream& stream : s.parts.streams) {
    const std::optional<double> newest = stream.stamp(belief.get());
    SourceHealth source;
    source.name = stream.source;
    source.age = newest ? report.stamp - *newest : std::numeric_limits<double>::infinity();
    source.limit = stream.limit;
    if (stream.count) {
      const StreamCount count = stream.count();
      source.received = count.received;
      source.dropped = count.overflown + count.too_old + count.unpaired + count.refused;
    }
    report.sources.push_back(std::move(source));
  }
  report.threads = s.supervisor.report(report.stamp);
  report.latencies = {{"capture to command", seen.capture_to_command},
                      {"planning step", seen.planning},
                      {"between commands", seen.command_period}};
  report.events = s.events.totals();
  for (const Event& event : s.events.since(0).events) {
    if (event.severity >= Severity::kWarning) report.newest.push_back(event);
  }
  if (report.newest.size() > kShown)
    report.newest.erase(report.newest.begin(), report.newest.end() - kShown);
  if (s.preflight) report.preflight = s.preflight->checks;
  return report;
}

}  // namespace prospect
