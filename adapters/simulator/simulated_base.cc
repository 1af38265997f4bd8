#include "adapters/simulator/simulated_base.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "models/knobs.h"

namespace prospect {
namespace {

void shift(Belief& belief, double by) {
  belief.stamp += by;
  belief.stamps.pose += by;
  belief.stamps.map += by;
  belief.stamps.landmarks += by;
  belief.stamps.ranges += by;
}

}  // namespace

SimulatedTruth truth_of(const Simulator& s) {
  return {s.true_pose(),   s.coverage(),   s.seen_area(), s.localization_error(),
          s.path_length(), s.collisions(), s.losses(),    s.picture()};
}

SimulatedBase::SimulatedBase(Simulator& simulator, const Clock& clock, const MotionModel& model,
                             const SimulatedBaseOptions& options)
    : simulator_(simulator),
      clock_(clock),
      options_(options),
      epoch_(clock.now()),
      motion_(options.faults),
      streams_(clock, options.faults, epoch_) {
  check_knobs("simulated base", options_);
  limits_.speed = model.max_speed();
  limits_.yaw_rate = model.max_yaw_rate();
  limits_.acceleration = model.max_deceleration();
  truth_ = truth_of(simulator_);
  last_report_ = last_passed_ = updated_ = epoch_;
}

bool SimulatedBase::link_passes(double now) const {
  return !holds(FaultSource::kLink, FaultVerb::kOff, now) &&
         !off_at_times(options_.faults, FaultSource::kLink, kLinkOnOff, now - epoch_);
}

Twist SimulatedBase::acting(double time) const {
  const Order* newest = nullptr;
  for (const Order& order : orders_) {
    if (order.acts > time) break;
    newest = &order;
  }
  return newest && time < newest->ends ? newest->command : Twist{};
}

void SimulatedBase::send(const Twist& command, double expires) noexcept {
  const double now = clock_.now();
  if (!link_passes(now) || !(expires > now)) return;
  if (holds(FaultSource::kLink, FaultVerb::kSlow, now)) {
    if (now - last_passed_ < kSlowLink) return;
    last_passed_ = now;
  }
  const bool late = holds(FaultSource::kLink, FaultVerb::kDelayed, now);
  const double comes = now + (late ? kFaultDelay : 0.0);
  // One that comes when it has expired is not executed.
  if (!(expires > comes)) return;
  const std::lock_guard lock(mutex_);
  const double acts = comes + options_.delay;
  // An order that overtakes others replaces them.
  while (!orders_.empty() && orders_.back().acts >= acts) orders_.pop_back();
  orders_.push_back({acts, std::min(expires, comes + options_.dead_man) + options_.delay,
                     motion_.made_of(command, now - epoch_)});
}

void SimulatedBase::stop() noexcept {
  const double now = clock_.now();
  if (!link_passes(now)) return;
  motion_.stop();
  const std::lock_guard lock(mutex_);
  while (!orders_.empty() && orders_.back().acts >= now) orders_.pop_back();
  orders_.push_back({now, now, Twist{}});
}

Twist SimulatedBase::measured(double now) {
  const auto has = [&](FaultVerb verb) { return holds(FaultSource::kWheels, verb, now); };
  Twist velocity = acting(has(FaultVerb::kDelayed) ? last_report_ - kFaultDelay : last_report_);
  if (!has(FaultVerb::kStuck)) {
    stuck_velocity_.reset();
  } else {
    velocity = stuck_velocity_ ? *stuck_velocity_ : velocity;
    stuck_velocity_ = velocity;
  }
  if (has(FaultVerb::kWrong)) {
    velocity.linear *= 2.0;
    velocity.yaw_rate *= 2.0;
  }
  if (off_at_times(options_.faults, FaultSource::kWheels, kLinkOnOff, now - epoch_)) velocity = {};
  if (has(FaultVerb::kGarbage)) {
    velocity.linear.setConstant(std::numeric_limits<double>::quiet_NaN());
    velocity.yaw_rate = std::numeric_limits<double>::quiet_NaN();
  }
  return velocity;
}

void SimulatedBase::sleep_as_faults_say() const {
  const double now = clock_.now(), sleep = command_sleep(options_.faults, now - epoch_);
  if (sleep > 0.0) clock_.wait_until(now + sleep, {});
}

BaseReport SimulatedBase::report() noexcept {
  sleep_as_faults_say();
  const double now = clock_.now();
  const std::lock_guard lock(mutex_);
  const bool stays =
      holds(FaultSource::kLink, FaultVerb::kStuck, now) ||
      (holds(FaultSource::kWheels, FaultVerb::kSlow, now) && now - last_report_ < kSlowFrames);
  if (link_passes(now) && !stays) last_report_ = now;
  BaseReport report;
  report.connected = true;
  report.stamp = last_report_;
  report.velocity = measured(now);
  if (holds(FaultSource::kWheels, FaultVerb::kOff, now)) {
    report.velocity = {};
    report.faults = {"the wheels' encoders do not answer"};
  }
  return report;
}

void SimulatedBase::advance(double now) {
  std::vector<std::pair<double, Twist>> pieces;  // end, and what acts until then
  {
    const std::lock_guard lock(mutex_);
    const double from = epoch_ + simulator_.time();
    std::vector<double> changes = {now};
    for (const Order& order : orders_) {
      for (const double t : {order.acts, order.ends}) {
        if (t > from && t < now) changes.push_back(t);
      }
    }
    std::sort(changes.begin(), changes.end());
    double at = from;
    for (const double change : changes) {
      pieces.emplace_back(change, acting(at));
      at = change;
    }
    // Those of the last seconds are asked for by encoders that are late.
    while (orders_.size() > 1 && orders_[1].acts <= now - kFaultDelay) {
      orders_.pop_front();
    }
  }
  for (const auto& [end, command] : pieces) {
    simulator_.apply(command, end - (epoch_ + simulator_.time()));
  }
}

std::shared_ptr<const Belief> SimulatedBase::update(const std::stop_token& stop) {
  if (!clock_.wait_until(updated_ + options_.belief_period, stop)) return nullptr;
  const double now = clock_.now();
  updated_ = now;
  advance(now);
  Belief belief = *simulator_.sense();
  shift(belief, epoch_);
  SimulatedTruth truth = truth_of(simulator_);
  {
    const std::lock_guard lock(mutex_);
    truth_ = std::move(truth);
  }
  std::optional<Belief> known = streams_.through(std::move(belief));
  if (!known) return nullptr;
  return std::make_shared<const Belief>(std::move(*known));
}

bool SimulatedBase::holds_command() const {
  const double now = clock_.now();
  const std::lock_guard lock(mutex_);
  return std::any_of(orders_.begin(), orders_.end(),
                     [&](const Order& order) { return order.acts <= now && now < order.ends; });
}

SimulatedTruth SimulatedBase::truth() const {
  const std::lock_guard lock(mutex_);
  return truth_;
}

}  // namespace prospect
