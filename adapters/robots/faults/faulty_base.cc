// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/faults/faulty_base.h"

#include <limits>
#include <utility>

namespace prospect {

FaultyBase::FaultyBase(Base& base, const Clock& clock, std::vector<InjectedFault> faults,
                       double start)
    : base_(base), clock_(clock), faults_(std::move(faults)), start_(start), motion_(faults_) {}

bool FaultyBase::link_passes(double now) const {
  return !holds(FaultSource::kLink, FaultVerb::kOff, now) &&
         !off_at_times(faults_, FaultSource::kLink, kLinkOnOff, now - start_);
}

void FaultyBase::pass_late(double now) noexcept {
  while (!late_.empty() && late_.front().comes <= now) {
    // One that comes when it has expired is not executed.
    const Command& command = late_.front();
    if (command.expires > now) {
      base_.send(motion_.made_of(command.twist, now - start_), command.expires);
    }
    late_.pop_front();
  }
}

void FaultyBase::send(const Twist& command, double expires) noexcept {
  const double now = clock_.now();
  pass_late(now);
  if (!link_passes(now)) return;
  if (holds(FaultSource::kLink, FaultVerb::kSlow, now)) {
    if (now - last_sent_ < kSlowLink) return;
    last_sent_ = now;
  }
  if (holds(FaultSource::kLink, FaultVerb::kDelayed, now)) {
    constexpr std::size_t kMost = 1000;
    if (late_.size() < kMost) late_.push_back({now + kFaultDelay, expires, command});
    return;
  }
  base_.send(motion_.made_of(command, now - start_), expires);
}

void FaultyBase::stop() noexcept {
  if (!link_passes(clock_.now())) return;
  late_.clear();
  motion_.stop();
  base_.stop();
}

Twist FaultyBase::measured(Twist velocity, double now) {
  const auto has = [&](FaultVerb verb) { return holds(FaultSource::kWheels, verb, now); };
  if (!has(FaultVerb::kStuck)) {
    stuck_.reset();
  } else {
    if (!stuck_) stuck_ = velocity;
    velocity = *stuck_;
  }
  if (has(FaultVerb::kWrong)) {
    velocity.linear *= 2.0;
    velocity.yaw_rate *= 2.0;
  }
  if (off_at_times(faults_, FaultSource::kWheels, kLinkOnOff, now - start_)) velocity = {};
  if (has(FaultVerb::kGarbage)) {
    velocity.linear.setConstant(std::numeric_limits<double>::quiet_NaN());
    velocity.yaw_rate = std::numeric_limits<double>::quiet_NaN();
  }
  return velocity;
}

void FaultyBase::measure(BaseReport& fresh, double now) {
  Measured newest;
  newest.time = now;
  for (WheelSample& sample : fresh.wheels) {
    const Twist twist =
        measured({{sample.velocity.x(), sample.velocity.y(), 0.0}, sample.yaw_rate}, now);
    sample.velocity = twist.linear.head<2>();
    sample.yaw_rate = twist.yaw_rate;
  }
  newest.wheels.swap(fresh.wheels);
  newest.velocity = measured(fresh.velocity, now);
  constexpr std::size_t kMost = 10'000;
  if (waiting_.size() == kMost) waiting_.pop_front();
  waiting_.push_back(std::move(newest));
}

BaseReport FaultyBase::report() noexcept {
  const double sleep = command_sleep(faults_, clock_.now() - start_);
  if (sleep > 0.0) clock_.wait_until(clock_.now() + sleep, {});
  const double now = clock_.now();
  pass_late(now);
  BaseReport fresh = base_.report();
  measure(fresh, now);
  const auto has = [&](FaultVerb verb) { return holds(FaultSource::kWheels, verb, now); };
  const bool stays = holds(FaultSource::kLink, FaultVerb::kStuck, now) || !link_passes(now) ||
                     (has(FaultVerb::kSlow) && now - last_told_ < kSlowFrames);
  if (stays) return told_;
  last_told_ = now;
  fresh.velocity = told_.velocity;
  std::vector<WheelSample> wheels;
  const double late = has(FaultVerb::kDelayed) ? kFaultDelay : 0.0;
  while (!waiting_.empty() && waiting_.front().time <= now - late) {
    const Measured& oldest = waiting_.front();
    fresh.velocity = oldest.velocity;
    wheels.insert(wheels.end(), oldest.wheels.begin(), oldest.wheels.end());
    waiting_.pop_front();
  }
  told_ = std::move(fresh);
  BaseReport report = told_;
  report.wheels = std::move(wheels);
  if (has(FaultVerb::kOff)) {
    report.velocity = {};
    report.wheels.clear();
    report.faults.emplace_back("the wheels' encoders do not answer");
  }
  return report;
}

}  // namespace prospect
