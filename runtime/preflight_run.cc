// SPDX-License-Identifier: Apache-2.0
#include "runtime/preflight_run.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <utility>

#include "engine/maps/pose_error.h"
#include "models/formatted.h"
#include "models/knobs.h"
#include "models/limited_twist.h"
#include "models/tracking_input.h"
#include "runtime/mission_observer.h"
#include "runtime/next_command.h"
#include "runtime/realtime_priority.h"
#include "runtime/stream_watch.h"

namespace prospect {
namespace {

/// A short motion from rest on one axis.
struct Motion {
  bool turns = false;   // to the left; else it drives straight ahead
  double amount = 0.0;  // [rad] or [m]
  double rate = 0.0;    // [rad/s] or [m/s]

  double of(const Twist& twist) const { return turns ? twist.yaw_rate : twist.linear.x(); }
  Twist wanted() const {
    return turns ? Twist{Eigen::Vector3d::Zero(), rate} : Twist{{rate, 0.0, 0.0}, 0.0};
  }
};

PreflightFacts::Place place_of(const Belief& belief) {
  const bool known = is_pose_covariance(belief.covariance) && !belief.covariance.isZero(0.0);
  return {belief.pose, known ? position_sigma(belief.covariance) : std::nan(""),
          belief.localization};
}

/// Of the newer of depth image and scan.
std::optional<PreflightFacts::Ranges> ranges_of(const NewestRanges& newest) {
  PreflightFacts::Ranges seen{0, 0, std::numeric_limits<double>::infinity()};
  const auto add = [&](double range) {
    ++seen.hits;
    seen.nearest = std::min(seen.nearest, range);
  };
  if (newest.scan.in_B && !(newest.depth.image && newest.depth.stamp > newest.scan.stamp)) {
    const DepthScan& scan = *newest.scan.in_B;
    seen.rays = scan.hits.size() + scan.misses.size();
    for (const Eigen::Vector3d& hit : scan.hits) add((hit - scan.origin).norm());
  } else if (newest.depth.image) {
    seen.rays = newest.depth.image->depth.size();
    for (const float z : newest.depth.image->depth) {
      if (std::isfinite(z) && z > 0.0F) add(z);
    }
  } else {
    return std::nullopt;
  }
  return seen;
}

/// The motion as a plan: the guard judges each command of it. None: the model cannot.
std::optional<Plan> plan_of(const MotionModel& model, const Pose& pose, double stamp,
                            const Motion& motion) {
  constexpr double kStep = 0.1;  // [s]
  Plan plan;
  plan.kind = PlanKind::kSeed;
  plan.stamp = stamp;
  plan.dt = kStep;
  plan.certified = true;
  const Twist wanted = motion.wanted();
  Twist before;
  Eigen::VectorXd x = model.state(pose, before), next(model.nx());
  plan.states.push_back(x);
  const int most = static_cast<int>(std::ceil(4.0 * motion.amount / (motion.rate * kStep))) + 10;
  for (double moved = 0.0; moved < motion.amount - 1e-9; moved += motion.of(before) * kStep) {
    if (static_cast<int>(plan.inputs.size()) == most) return std::nullopt;
    Eigen::VectorXd input = tracking_input(model, x, model.input(before), wanted, kStep);
    model.step(x, input, kStep, next);
    x = next;
    before = model.twist(x, input);
    plan.inputs.push_back(std::move(input));
    plan.states.push_back(x);
    plan.commands.push_back(before);
  }
  plan.committed = static_cast<int>(plan.commands.size());
  // Braking adds to it: a base that starts more slowly than it stops loses less of it so.
  for (int k = 0; k < most && !is_at_rest(before); ++k) {
    before = braking_command(model, pose, before, kStep).command;
    plan.tail.push_back(before);
  }
  return plan;
}

class Run {
 public:
  Run(const DriverParts& parts, Base& base, BeliefSource& beliefs,
      const PreflightRunOptions& options, const DriverOptions& driver,
      const PreflightInputs& inputs)
      : parts_(parts),
        base_(base),
        beliefs_(beliefs),
        options_(options),
        driver_(driver),
        command_(driver.command),
        inputs_(inputs),
        gyro_(driver.following.gyro_bias) {}

  PreflightResult make() {
    const std::jthread perceives([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        if (auto newest = beliefs_.update(stop)) {
          tell(inputs_.observers, &MissionObserver::on_belief, *newest);
          const std::lock_guard lock(mutex_);
          belief_ = std::move(newest);
        }
      }
    });
    const RealtimePriority first(driver_.priority);
    PreflightResult result;
    PreflightFacts facts = inputs_.known;
    if (driver_.priority > 0) facts.priority = first.problem();
    watch(facts);
    if (inputs_.floor) facts.floor = floor();
    facts.dead_man = base_.dead_man();
    facts.command_period = command_.period;
    const BaseLimits limits = base_.limits();
    facts.speed = {limits.speed, parts_.model->max_speed()};
    facts.yaw_rate = {limits.yaw_rate, parts_.model->max_yaw_rate()};
    facts.deceleration = {limits.acceleration, parts_.model->max_deceleration()};
    result.checks = checks_before_motion(facts, options_.checks);

    const MotionModel& model = *parts_.model;
    ShortMotion turned, driven;
    const std::string no_turn =
        try_motion({true, options_.turn, std::min(options_.turn_rate, 0.5 * model.max_yaw_rate())},
                   result, turned);
    add(checks_of_turn(turned, options_.checks), "no turn: ", no_turn, result);
    const std::string no_way =
        try_motion({false, options_.distance, std::min(options_.speed, 0.5 * model.max_speed())},
                   result, driven);
    add(checks_of_distance(driven, options_.checks), "no way: ", no_way, result);
    result.yaw_checked = no_turn.empty() && (turned.wheels || turned.pose);
    if (is_cancelled()) {
      result.checks.push_back({"checks", CheckVerdict::kFailed, "they were cancelled"});
    }
    base_.stop();
    return result;
  }

 private:
  /// Why the motion was not made, or not whole; empty: it was.
  std::string try_motion(const Motion& motion, PreflightResult& result, ShortMotion& made) {
    if (!first_failed(result.checks).empty()) return "a check before it has failed";
    if (!(motion.amount > 0.0)) return "not asked for";
    const std::string hindered = move(motion, made);
    if (departure_) {
      result.checks.push_back({"following", CheckVerdict::kFailed, to_text(*departure_)});
    }
    return hindered;
  }
  static void add(std::vector<CheckResult> checks, const std::string& no_motion,
                  const std::string& hindered, PreflightResult& result) {
    for (CheckResult& check : checks) {
      if (!hindered.empty()) {
        check = {check.check, CheckVerdict::kNotPossible, no_motion + hindered};
      }
      result.checks.push_back(std::move(check));
    }
  }
  bool is_cancelled() const { return inputs_.cancelled && inputs_.cancelled(); }
  std::shared_ptr<const Belief> newest() {
    const std::lock_guard lock(mutex_);
    return belief_;
  }

  /// What the base has measured since the call before goes to the inbox.
  BaseReport report() {
    BaseReport report = base_.report();
    if (parts_.inbox) {
      for (const WheelSample& sample : report.wheels) parts_.inbox->wheels(sample);
    }
    return report;
  }
  /// By its gyro, since the call before.
  std::optional<GyroRate::Turn> turned() {
    if (!parts_.inbox) return std::nullopt;
    return gyro_.look(
        parts_.inbox->imu_since(gyro_.stamp().value_or(-std::numeric_limits<double>::infinity())));
  }
  bool rests(const BaseReport& base) const {
    return base.velocity.linear.norm() <= driver_.watch.rest_speed &&
           std::abs(base.velocity.yaw_rate) <= driver_.watch.rest_rate;
  }
  /// Why it cannot be driven; empty: it can.
  std::string misses(const BaseReport& base, double now) const {
    if (!base.connected) return "it is not connected";
    if (!base.faults.empty()) return base.faults.front();
    const double age = now - base.stamp;
    return std::abs(age) <= driver_.watch.max_silence
               ? ""
               : formatted("its newest word is %.2f s old", age);
  }

  /// The middle one of some looks, as one alone may be wrong; none: most of them saw none.
  std::optional<PreflightFacts::Floor> floor() {
    constexpr int kLooks = 3;
    constexpr double kApart = 0.2;  // [s], longer than a frame
    using Floor = PreflightFacts::Floor;
    std::vector<Floor> seen;
    for (int k = 0; k < kLooks; ++k) {
      if (k > 0) stand(kApart);
      if (const std::optional<Floor> look = inputs_.floor()) seen.push_back(*look);
    }
    if (2 * seen.size() <= kLooks) return std::nullopt;
    const auto height = [](const Floor& f) {
      return std::isfinite(f.height) ? f.height : HUGE_VAL;
    };
    const auto middle = seen.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2);
    std::nth_element(seen.begin(), middle, seen.end(),
                     [&](const Floor& a, const Floor& b) { return height(a) < height(b); });
    return *middle;
  }

  void stand(double seconds) {
    for (const double end = parts_.clock.now() + seconds; parts_.clock.now() < end; wait()) {
      report();
      base_.send({}, parts_.clock.now() + command_.hold);
    }
  }
  void wait() { parts_.clock.wait_until(parts_.clock.now() + command_.period, {}); }

  /// The robot stands while its streams come.
  void watch(PreflightFacts& facts) {
    std::vector<PreflightFacts::Stream> all;
    for (const WatchedStream& s : parts_.streams) all.push_back({s.source, 0.0, s.limit, 0.0});
    StreamWatch watch(std::move(all), parts_.clock.now());
    const double begin = parts_.clock.now();
    std::vector<std::uint64_t> before;
    for (const WatchedStream& s : parts_.streams) {
      before.push_back(s.count ? s.count().received : 0);
    }
    const double end = parts_.clock.now() + options_.patience;
    std::vector<double> offsets;
    for (;;) {
      const BaseReport told = report();
      const std::shared_ptr<const Belief> belief = newest();
      const double now = parts_.clock.now();
      facts.base = misses(told, now);
      if (const auto turn = turned(); turn && rests(told)) gyro_.stood(*turn);
      const auto offset = parts_.inbox ? parts_.inbox->pair_offset() : std::nullopt;
      if (offset) offsets.push_back(*offset);
      for (std::size_t k = 0; k < parts_.streams.size(); ++k) {
        watch.look(k, parts_.streams[k].stamp(belief.get()), now);
      }
      const bool located = belief && belief->localization != Localization::kLost;
      if (parts_.emergency_stop) facts.emergency_stop = parts_.emergency_stop->state(now);
      const bool ready = located && facts.base->empty() &&
                         watch.live_for(options_.checks.live_time) &&
                         !is_stopped(facts.emergency_stop);
      if (ready || now >= end || is_cancelled()) break;
      base_.send({}, now + command_.hold);
      wait();
    }
    facts.streams = watch.streams();
    if (const std::shared_ptr<const Belief> belief = newest()) facts.place = place_of(*belief);
    if (parts_.inbox) facts.ranges = ranges_of(parts_.inbox->ranges());
    const double watched = parts_.clock.now() - begin;
    for (std::size_t k = 0; k < parts_.streams.size(); ++k) {
      const WatchedStream& s = parts_.streams[k];
      PreflightFacts::Clock clock{s.source, 0.0, 0};
      if (s.count) {
        const StreamCount count = s.count();
        if (watched > 0.0) {
          facts.streams[k].rate = static_cast<double>(count.received - before[k]) / watched;
        }
        clock.offset = count.offset;
        clock.jumps = count.jumps;
      }
      facts.clocks.push_back(clock);
    }
    if (!offsets.empty() && !facts.stereo_offset) {
      const auto middle = offsets.begin() + static_cast<std::ptrdiff_t>(offsets.size() / 2);
      std::nth_element(offsets.begin(), middle, offsets.end());
      facts.stereo_offset = *middle;
    }
  }

  static bool is_stopped(const std::optional<EmergencyStopState>& button) {
    return button && (button->pressed || !button->silent.empty());
  }
  bool is_told_to_stand(double now) const {
    if (parts_.emergency_stop && is_stopped(parts_.emergency_stop->state(now))) return true;
    return parts_.requests &&
           (!parts_.requests->told_to_drive() || parts_.requests->emergency_stop_waits());
  }

  /// Moves, and notes what came of it; why not, if it cannot.
  std::string move(const Motion& motion, ShortMotion& made) {
    const std::shared_ptr<const Belief> before = newest();
    if (!before || before->localization == Localization::kLost) return "localization is lost";
    const char* cannot = motion.turns ? "the model does not turn on the spot"
                                      : "the model does not drive straight ahead";
    if (!(motion.rate > 0.0)) return cannot;
    const std::optional<Plan> plan =
        plan_of(*parts_.model, before->pose, parts_.clock.now() + command_.period, motion);
    if (!plan) return cannot;
    const auto shared = std::make_shared<const Plan>(*plan);
    const double end =
        plan->stamp + plan->dt * static_cast<double>(plan->commands.size() + plan->tail.size());
    CommandLoop loop(parts_.model, parts_.guard, command_);
    CommandFollowing following(driver_.following, command_.delay);
    std::string hindered;
    double wheels = 0.0, stamp = 0.0, gyro = 0.0, last = parts_.clock.now();
    turned();
    Twist in_force;
    bool by_wheels = false;
    for (;;) {
      const BaseReport told = report();
      const double now = parts_.clock.now();
      made.commanded += motion.of(in_force) * (now - last);
      for (const WheelSample& sample : told.wheels) {
        const double rate = motion.turns ? sample.yaw_rate : sample.velocity.x();
        if (by_wheels) wheels += rate * (sample.stamp - stamp);
        by_wheels = true;
        stamp = sample.stamp;
      }
      if (!by_wheels) wheels += motion.of(told.velocity) * (now - last);
      if (const auto turn = turned()) gyro += turn->rate * (turn->until - turn->from);
      last = now;
      if (now >= end + options_.settle) break;
      if (is_cancelled()) return "it was cancelled";
      if (is_told_to_stand(now)) return "it was told to stand";
      const std::shared_ptr<const Belief> seen = newest();
      departure_ = following.look(now, told, parts_.pose_of_wheels ? nullptr : seen.get());
      if (departure_) {
        base_.stop();
        return "the base does not follow what it is told";
      }
      const RangeCheck look = parts_.ranges ? parts_.ranges(in_force, now) : RangeCheck();
      const CommandStep step =
          loop.step({now, shared, seen, told, DriveSpeed{DriveResponse::kFull, 1.0}, look.share});
      in_force = step.command;
      following.told({now, step.expires, step.command, step.stop});
      if (step.stop) {
        base_.stop();
      } else {
        base_.send(step.command, step.expires);
      }
      if (hindered.empty() && !step.detail.empty()) {
        hindered = look.obstacle.empty() ? step.detail : look.obstacle;
      }
      if (step.reason == CommandReason::kBase) return hindered;
      wait();
    }
    made.wheels = wheels;
    made.has_gyro = parts_.inbox && parts_.inbox->count(SensorStream::kImu).received > 0;
    if (gyro_.knows_bias()) made.gyro = gyro;
    const std::shared_ptr<const Belief> after = newest();
    if (after->localization != Localization::kLost) {
      const double yaw = before->pose.yaw;
      const Eigen::Vector3d way = after->pose.position - before->pose.position;
      made.pose = motion.turns ? std::remainder(after->pose.yaw - yaw, 2.0 * M_PI)
                               : way.x() * std::cos(yaw) + way.y() * std::sin(yaw);
    }
    return hindered;
  }

  const DriverParts& parts_;
  Base& base_;
  BeliefSource& beliefs_;
  const PreflightRunOptions& options_;
  const DriverOptions& driver_;
  const CommandLoopOptions& command_;
  const PreflightInputs& inputs_;
  std::mutex mutex_;
  std::shared_ptr<const Belief> belief_;
  std::optional<Departure> departure_;  // that ended a motion
  GyroRate gyro_;
};

}  // namespace

PreflightResult run_preflight(const DriverParts& parts, Base& base, BeliefSource& beliefs,
                              const PreflightRunOptions& options, const DriverOptions& driver,
                              const PreflightInputs& inputs) {
  check_knobs("preflight", options);
  check_knobs("driver", driver);
  if (!parts.model) throw std::invalid_argument("preflight: no motion model; expected one");
  return Run(parts, base, beliefs, options, driver, inputs).make();
}

}  // namespace prospect
