#include "adapters/simulator/simulated_base.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/knobs.h"

namespace prospect {
namespace {

constexpr double kOnOff = 1.0;      // [s] that a sensor which fails at times is on, and off
constexpr double kLinkOnOff = 0.5;  // [s] likewise of the link

/// In every other interval of that length.
bool off_now(double since, double length) { return std::fmod(since, 2.0 * length) < length; }

void shift(Belief& belief, double by) {
  belief.stamp += by;
  belief.stamps.pose += by;
  belief.stamps.map += by;
  belief.stamps.landmarks += by;
  belief.stamps.ranges += by;
}

void take_cameras(const Belief& from, Belief& to) {
  to.pose = from.pose;
  to.covariance = from.covariance;
  to.twist = from.twist;
  to.localization = from.localization;
  to.tracked_features = from.tracked_features;
  to.landmarks = from.landmarks;
  to.stamps.pose = from.stamps.pose;
  to.stamps.landmarks = from.stamps.landmarks;
}

void take_depth(const Belief& from, Belief& to) {
  to.octree = from.octree;
  to.voxels = from.voxels;
  to.ground = from.ground;
  to.stamps.map = from.stamps.map;
  to.stamps.ranges = from.stamps.ranges;
}

}  // namespace

SimulatedTruth truth_of(const Simulator& s) {
  return {s.true_pose(),   s.coverage(),   s.seen_area(), s.localization_error(),
          s.path_length(), s.collisions(), s.losses(),    s.picture()};
}

SimulatedBase::SimulatedBase(Simulator& simulator, const Clock& clock, const MotionModel& model,
                             const SimulatedBaseOptions& options)
    : simulator_(simulator), clock_(clock), options_(options), epoch_(clock.now()) {
  check_knobs("simulated base", options_);
  limits_.speed = model.max_speed();
  limits_.yaw_rate = model.max_yaw_rate();
  limits_.acceleration = model.max_deceleration();
  truth_ = truth_of(simulator_);
  last_report_ = updated_ = epoch_;
}

bool SimulatedBase::link_passes(double now) const {
  const double time = now - epoch_;
  if (fault_at(options_.faults, FaultSource::kLink, FaultVerb::kOff, time)) return false;
  const InjectedFault* at_times =
      fault_at(options_.faults, FaultSource::kLink, FaultVerb::kIntermittent, time);
  return !at_times || !off_now(time - at_times->from, kLinkOnOff);
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
  const bool late =
      fault_at(options_.faults, FaultSource::kLink, FaultVerb::kDelayed, now - epoch_) != nullptr;
  const double comes = now + (late ? kFaultDelay : 0.0);
  // One that comes when it has expired is not executed.
  if (!(expires > comes)) return;
  const std::lock_guard lock(mutex_);
  const double acts = comes + options_.delay;
  // An order that overtakes others replaces them.
  while (!orders_.empty() && orders_.back().acts >= acts) orders_.pop_back();
  orders_.push_back({acts, std::min(expires, comes + options_.dead_man) + options_.delay, command});
}

void SimulatedBase::stop() noexcept {
  const double now = clock_.now();
  if (!link_passes(now)) return;
  const std::lock_guard lock(mutex_);
  while (!orders_.empty() && orders_.back().acts >= now) orders_.pop_back();
  orders_.push_back({now, now, Twist{}});
}

BaseReport SimulatedBase::report() noexcept {
  const double now = clock_.now();
  const std::lock_guard lock(mutex_);
  if (link_passes(now)) last_report_ = now;
  BaseReport report;
  report.connected = true;
  report.stamp = last_report_;
  report.velocity = acting(last_report_);
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
    while (orders_.size() > 1 && orders_[1].acts <= now) orders_.pop_front();
  }
  for (const auto& [end, command] : pieces) {
    simulator_.apply(command, end - (epoch_ + simulator_.time()));
  }
}

std::shared_ptr<const Belief> SimulatedBase::as_faults_say(Belief belief, double now) {
  const double time = now - epoch_;
  before_.push_back(belief);
  while (before_.size() > 2 && before_[1].stamp <= now - kFaultDelay) before_.pop_front();
  const auto source = [&](FaultSource which, std::optional<Belief>& newest, const auto& take) {
    const bool off = fault_at(options_.faults, which, FaultVerb::kOff, time) != nullptr;
    const InjectedFault* at_times =
        fault_at(options_.faults, which, FaultVerb::kIntermittent, time);
    if (!off && !(at_times && off_now(time - at_times->from, kOnOff))) {
      const bool late = fault_at(options_.faults, which, FaultVerb::kDelayed, time) != nullptr;
      newest = late ? before_.front() : belief;
    }
    if (newest) take(*newest, belief);
  };
  source(FaultSource::kCameras, of_cameras_, take_cameras);
  source(FaultSource::kDepth, of_depth_, take_depth);
  return std::make_shared<const Belief>(std::move(belief));
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
  return as_faults_say(std::move(belief), now);
}

SimulatedTruth SimulatedBase::truth() const {
  const std::lock_guard lock(mutex_);
  return truth_;
}

}  // namespace prospect
