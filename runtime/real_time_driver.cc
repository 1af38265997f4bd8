#include "runtime/real_time_driver.h"

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

#include "models/knobs.h"
#include "models/limited_twist.h"
#include "runtime/mission_progress.h"
#include "runtime/planning_latency.h"
#include "runtime/predicted_belief.h"
#include "runtime/supervisor.h"

namespace prospect {
namespace {

enum SupervisedIndex { kPerception, kPlanner, kCommand };

constexpr double kPoll = 0.02;         // [s] in which who waits for the end looks
constexpr double kLongestStop = 10.0;  // [s] after which a base that does not stop is left alone

std::vector<SupervisedThread> threads_of(const RealTimeOptions& o) {
  return {{"perception", o.perception_limit},
          {"planner", o.planner_limit},
          {"command", o.command_limit}};
}

const RobotParts& checked(const RobotParts& parts) {
  if (!parts.model) throw std::invalid_argument("driver: no motion model; expected one");
  const std::optional<double> dead_man = parts.base.dead_man();
  if (!dead_man || !(*dead_man > 0.0)) {
    throw std::invalid_argument("base " + parts.base.name() +
                                ": it declares no dead-man; expected a base that stops by itself "
                                "when commands cease, or a relay beside it that does");
  }
  return parts;
}

const RealTimeOptions& checked(const RealTimeOptions& options) {
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

/// Tells which stream's clock has jumped since it was asked the last time.
class ClockJumps {
 public:
  /// Name of the stream; empty: none has.
  std::string since_last(const SensorInbox* inbox) {
    std::string jumped;
    for (std::size_t k = 0; inbox && k < kSensorStreams; ++k) {
      const auto stream = static_cast<SensorStream>(k);
      const int jumps = inbox->count(stream).jumps;
      if (jumps > seen_[k]) jumped = to_string(stream);
      seen_[k] = jumps;
    }
    return jumped;
  }

 private:
  std::array<int, kSensorStreams> seen_{};
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

struct RealTimeDriver::Impl {
  RobotParts parts;
  RealTimeOptions options;
  EventLog events;
  Supervisor supervisor;

  Newest<std::shared_ptr<const Belief>> belief;
  Newest<NewestPlan> plan;
  Newest<CommandState> command;
  Newest<DriverStatus> status;

  DriveRequests own_requests;
  DriveRequests& requests;
  std::atomic<bool> cancelled{false}, over{false};
  std::atomic<bool> at_rest{false};  // after `over`
  std::atomic<int> guard_stops{0};   // since the last planning step
  std::atomic<GuardReason> guard_reason{GuardReason::kPassed};
  std::exception_ptr thrown;                // by the planner's thread, read once it is joined
  std::vector<MissionObserver*> observers;  // of the mission that is driven
  LatencyHistogram planning;  // the planner's thread's own, handed on by planning_seen
  Newest<LatencyHistogram> planning_seen;

  Impl(const RobotParts& p, const RealTimeOptions& o)
      : parts(checked(p)),
        options(checked(o)),
        supervisor(threads_of(o), p.clock.now()),
        requests(p.requests ? *p.requests : own_requests) {}

  double now() const { return parts.clock.now(); }
  void perceive(const std::stop_token& stop);
  void plan_on(const std::stop_token& stop, MissionProgress& progress);
  void send(const std::stop_token& stop);
  /// Tells observers of new events, and how the robot is, if it is time again or the end.
  void report(const RealTimeDriver& driver, bool at_end);
  std::uint64_t next_event = 0;                                // of those that they were told of
  double reported = -std::numeric_limits<double>::infinity();  // [s]
  /// Of the command thread, which cannot say itself that it hangs: the base's dead-man is what is
  /// left then.
  void watch_command_thread(bool& late);
};

void RealTimeDriver::Impl::perceive(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    supervisor.beat(kPerception, now());
    if (std::shared_ptr<const Belief> newest = parts.beliefs.update(stop)) {
      if (!observers.empty()) {
        if (const CameraPicture picture = parts.beliefs.picture(); picture.image) {
          tell(observers, &MissionObserver::on_picture, picture);
        }
      }
      tell(observers, &MissionObserver::on_belief, *newest);
      belief.set(std::move(newest));
    }
  }
}

void RealTimeDriver::Impl::plan_on(const std::stop_token& stop, MissionProgress& progress) {
  const CommandLoopOptions& command_options = options.command;
  PlanningLatency latency(options.least_latency, options.most_latency,
                          2.0 * command_options.period);
  PlanningLatency preparation(0.0, options.most_latency, 0.0);
  double start = -std::numeric_limits<double>::infinity();  // of the newest plan
  NewestPlan published;
  while (!stop.stop_requested()) {
    supervisor.beat(kPlanner, now());
    std::shared_ptr<const Belief> newest = belief.get();
    if (!newest) {
      Belief nothing;
      nothing.localization = Localization::kLost;
      if (progress.over_before(nothing, now(), cancelled)) break;
      parts.clock.wait_until(now() + kPoll, stop);
      continue;
    }
    // Not before the plan before has begun: its successor is predicted through it.
    const double lead = latency.value(), ahead = preparation.value();
    start = std::max(now() + ahead + lead, start + std::max(options.replan_period, ahead + lead));
    if (!parts.clock.wait_until(start - lead - ahead, stop)) break;
    const double prepared = now();
    progress.prepare(*belief.get());
    preparation.add(now() - prepared);
    start = std::max(start, now() + lead);
    if (!parts.clock.wait_until(start - lead, stop)) break;
    newest = belief.get();
    const double begun = now();
    if (progress.over_before(*newest, begun, cancelled)) break;
    progress.take_detour(requests);
    const CommandState state = command.get();
    const std::vector<SentCommand> commands =
        commands_until(*parts.model, state, begun, start, command_options.period);
    const Belief predicted = predicted_belief(*newest, commands, start, command_options.delay);
    published.plan = progress.plan(*newest, predicted, begun);
    if (!published.plan) break;
    if (is_at_rest(predicted.twist)) published.from_rest = predicted.stamp;
    plan.set(published);
    const double took = now() - begun;
    latency.add(took);
    planning.add(took);
    planning_seen.set(planning);

    const GuardStops stops{guard_stops.exchange(0), guard_reason.exchange(GuardReason::kPassed)};
    progress.result.guard_stops += stops.count;
    try {
      if (progress.over_after(*newest, *published.plan, stops)) break;
    } catch (...) {
      thrown = std::current_exception();
      break;
    }
  }
  over = true;
  // What is over is not late: it beats until it is joined.
  while (!stop.stop_requested()) {
    supervisor.beat(kPlanner, now());
    parts.clock.wait_until(now() + kPoll, stop);
  }
}

void RealTimeDriver::Impl::send(const std::stop_token& stop) {
  CommandLoop loop(parts.model, parts.guard, options.command);
  DriveWatch watch(options.watch);
  CommandFollowing following(options.following, options.command.delay);
  DriveState mode;
  DriverStatus seen;
  ClockJumps jumps;
  Standstill standstill(now());
  mode.since = now();
  double tick = now(), before = tick;
  const double period = options.command.period;
  while (!stop.stop_requested()) {
    supervisor.beat(kCommand, now());
    const BaseReport report = parts.base.report();
    if (parts.inbox) {
      for (const WheelSample& sample : report.wheels) parts.inbox->wheels(sample);
    }
    const std::shared_ptr<const Belief> newest = belief.get();
    const NewestPlan newest_plan = plan.get();
    const CommandState state = loop.state();
    const double instant = now();  // after what was read, so that nothing is from the future
    const RangeCheck look = parts.ranges ? parts.ranges(state.command, instant) : RangeCheck();

    DriveObservation observation;
    observation.now = instant;
    observation.belief = newest.get();
    if (newest) observation.stale_source = parts.guard.stale_source(*newest, instant);
    observation.base = &report;
    observation.sent = state.sent;
    observation.threads = supervisor.report(instant);
    observation.plan_from_rest = newest_plan.from_rest;
    observation.plan_left = time_left(newest_plan.plan.get(), instant);
    observation.obstacle = look.obstacle;
    observation.jumped_clock = jumps.since_last(parts.inbox);
    observation.told_to_drive = requests.told_to_drive();
    const EmergencyStopState button =
        parts.emergency_stop ? parts.emergency_stop->state(instant) : EmergencyStopState();
    // Requests tell it once: the drive mode latches it.
    observation.emergency_stop = requests.take_emergency_stop() || button.pressed;
    observation.silent_emergency_stop = button.silent;
    if (const auto departure = following.look(instant, report, newest.get())) {
      observation.not_following = to_text(*departure);
    }
    observation.acknowledged = requests.take_acknowledgement();
    observation.task_over = over;
    observation.failed_preflight = parts.failed_preflight;
    observation.yaw_checked = parts.yaw_checked;
    const DriveFacts facts = watch.facts(observation);
    const DriveState next = decide(mode, facts, options.mode);
    if (next.mode != mode.mode || next.cause != mode.cause) {
      const bool bad = next.mode == DriveMode::kStopping || next.mode == DriveMode::kStopped;
      events.add(instant,
                 next.mode == DriveMode::kStopped    ? Severity::kFatal
                 : bad && !over                      ? Severity::kError
                 : next.mode == DriveMode::kDegraded ? Severity::kWarning
                                                     : Severity::kInfo,
                 "drive mode", to_string(next.cause), describe(next, facts));
    }
    mode = next;
    requests.set_stopped(mode.mode == DriveMode::kStopped);

    const CommandStep step = loop.step(
        {instant, newest_plan.plan, newest, report, drive_speed(mode, options.mode), look.share});
    if (step.stop) {
      parts.base.stop();
    } else {
      parts.base.send(step.command, step.expires);
    }
    following.told({instant, step.expires, step.command, step.stop});
    tell(observers, &MissionObserver::on_command, instant, step.stop ? Twist{} : step.command);
    command.set(loop.state());
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
    at_rest = over && facts.rest_for > 0.0 && step.command.linear.isZero(0.0) &&
              step.command.yaw_rate == 0.0;

    const bool stands = is_at_rest(step.command) || facts.rest_for > 0.0;
    if (standstill.is_long(instant, observation.told_to_drive && !over && stands)) {
      std::string why = describe(mode, facts);
      if (!step.detail.empty()) why += " " + step.detail + ".";
      if (newest_plan.plan) why += " The planner: " + newest_plan.plan->why;
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

    tick += period;
    // A tick that was missed is left out: commands come no faster than the period.
    if (now() > tick) tick = now();
    parts.clock.wait_until(tick, stop);
  }
}

void RealTimeDriver::Impl::watch_command_thread(bool& late) {
  const double time = now();
  const ThreadReport command_thread = supervisor.report(time)[kCommand];
  const bool is_late = command_thread.state != ThreadState::kOnTime &&
                       command_thread.state != ThreadState::kStarting;
  if (is_late && !late) {
    events.add(
        time, Severity::kError, "supervisor", "thread late",
        "the command thread does not answer: " + std::string(to_string(command_thread.state)) +
            "; the base's dead-man is what stops the robot");
  }
  late = is_late;
}

void RealTimeDriver::Impl::report(const RealTimeDriver& driver, bool at_end) {
  if (observers.empty()) return;
  const EventLog::Reading reading = events.since(next_event);
  next_event = reading.next;
  if (!reading.events.empty()) {
    tell(observers, &MissionObserver::on_events, std::span<const Event>(reading.events));
  }
  constexpr double kEvery = 0.2;  // [s]
  if (!at_end && now() - reported < kEvery) return;
  reported = now();
  tell(observers, &MissionObserver::on_status, driver.status(), driver.health());
}

RealTimeDriver::RealTimeDriver(const RobotParts& parts, const RealTimeOptions& options)
    : impl_(std::make_unique<Impl>(parts, options)) {}
RealTimeDriver::~RealTimeDriver() = default;

MissionResult RealTimeDriver::run(const MissionOptions& mission) {
  Impl& s = *impl_;
  MissionProgress progress(mission, s.parts.planner, s.now());
  s.observers = mission.observers;
  s.parts.beliefs.watched_by(mission.observers);
  {
    // In the order in which they are needed; the command thread ends last.
    std::jthread command([&s](const std::stop_token& stop) { s.send(stop); });
    std::jthread planner([&](const std::stop_token& stop) { s.plan_on(stop, progress); });
    std::jthread perception([&s](const std::stop_token& stop) { s.perceive(stop); });
    const std::stop_token never;
    bool late = false;
    while (!s.over) {
      s.parts.clock.wait_until(s.now() + kPoll, never);
      s.watch_command_thread(late);
      s.report(*this, false);
      if (mission.cancelled && mission.cancelled()) s.cancelled = true;
    }
    const double end = s.now();
    while (!s.at_rest && s.now() - end < kLongestStop) {
      s.parts.clock.wait_until(s.now() + kPoll, never);
    }
  }
  s.parts.base.stop();
  s.parts.beliefs.watched_by({});
  s.report(*this, true);
  if (s.thrown) std::rethrow_exception(s.thrown);
  tell(s.observers, &MissionObserver::on_end, progress.result);
  return progress.result;
}

void RealTimeDriver::emergency_stop() noexcept { impl_->requests.emergency_stop(); }
void RealTimeDriver::acknowledge() noexcept { impl_->requests.acknowledge(); }
void RealTimeDriver::hold() noexcept { impl_->requests.hold(); }
void RealTimeDriver::resume() noexcept { impl_->requests.resume(); }

DriverStatus RealTimeDriver::status() const {
  DriverStatus status = impl_->status.get();
  status.planning = impl_->planning_seen.get();
  return status;
}
HealthReport RealTimeDriver::health() const {
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
  report.preflight = s.parts.preflight;
  return report;
}

const EventLog& RealTimeDriver::events() const { return impl_->events; }

}  // namespace prospect
