// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/simulated_base.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "models/knobs.h"

namespace prospect {

TrueState truth_of(const Simulator& s) {
  TrueState truth{s.true_pose(),   s.coverage(),   s.seen_area(), s.localization_error(),
                  s.path_length(), s.collisions(), s.losses(),    s.fallen(),
                  s.bumps()};
  for (const Walker& walker : s.walkers()) truth.people.push_back(walker.at);
  return truth;
}

SimulatedBase::SimulatedBase(Simulator& simulator, const Clock& clock, const MotionModel& model,
                             const SimulatedBaseOptions& options)
    : simulator_(simulator), clock_(clock), options_(options), epoch_(clock.now()) {
  check_knobs("simulated base", options_);
  limits_.speed = model.max_speed();
  limits_.yaw_rate = model.max_yaw_rate();
  limits_.acceleration = model.max_deceleration();
  truth_ = truth_of(simulator_);
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
  if (!(expires > now)) return;
  const std::lock_guard lock(mutex_);
  const double acts = now + options_.delay;
  // One of the same instant replaces the other.
  while (!orders_.empty() && orders_.back().acts >= acts) orders_.pop_back();
  orders_.push_back({acts, std::min(expires, now + options_.dead_man) + options_.delay, command});
}

void SimulatedBase::stop() noexcept {
  const double now = clock_.now();
  const std::lock_guard lock(mutex_);
  while (!orders_.empty() && orders_.back().acts >= now) orders_.pop_back();
  orders_.push_back({now, now, Twist{}});
}

BaseReport SimulatedBase::report() noexcept {
  const std::lock_guard lock(mutex_);
  BaseReport report;
  report.connected = true;
  report.stamp = clock_.now();  // under the lock: advance() forgets what acted before
  report.velocity = acting(report.stamp);
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
  TrueState truth = truth_of(simulator_);
  const std::lock_guard lock(mutex_);
  truth_ = std::move(truth);
}

bool SimulatedBase::holds_command() const {
  const double now = clock_.now();
  const std::lock_guard lock(mutex_);
  return std::any_of(orders_.begin(), orders_.end(),
                     [&](const Order& order) { return order.acts <= now && now < order.ends; });
}

TrueState SimulatedBase::newest() const {
  const std::lock_guard lock(mutex_);
  return truth_;
}

}  // namespace prospect
