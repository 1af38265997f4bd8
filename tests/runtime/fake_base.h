// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/unicycle.h"
#include "runtime/base.h"
#include "runtime/clock.h"

namespace prospect::test {

/// Moves exactly as it is told, as a unicycle, up to the expiry of each command. Any thread.
class FakeBase final : public Base {
 public:
  explicit FakeBase(const Clock& clock, std::optional<double> dead_man = 0.5)
      : clock_(clock), dead_man_(dead_man), moved_until_(clock.now()) {}

  std::string name() const noexcept override { return "fake"; }
  std::optional<double> dead_man() const noexcept override { return dead_man_; }
  void send(const Twist& command, double expires) noexcept override {
    const std::lock_guard lock(mutex_);
    move();
    command_ = command;
    expires_ = expires;
    sent_.emplace_back(clock_.now(), command);
  }
  void stop() noexcept override {
    const std::lock_guard lock(mutex_);
    move();
    command_ = {};
    ++stops_;
  }
  BaseReport report() noexcept override {
    const std::lock_guard lock(mutex_);
    move();
    BaseReport report;
    report.connected = connected_;
    report.stamp = moved_until_;
    report.velocity = command_;
    report.faults = faults_;
    return report;
  }

  // For tests.
  Pose pose() {
    const std::lock_guard lock(mutex_);
    move();
    return pose_;
  }
  Twist velocity() {
    const std::lock_guard lock(mutex_);
    move();
    return command_;
  }
  void set_fault(std::string fault) {
    const std::lock_guard lock(mutex_);
    faults_ = {std::move(fault)};
  }
  void disconnect() {
    const std::lock_guard lock(mutex_);
    connected_ = false;
  }
  int stops() const {
    const std::lock_guard lock(mutex_);
    return stops_;
  }
  /// With the times at which they came.
  std::vector<std::pair<double, Twist>> sent() const {
    const std::lock_guard lock(mutex_);
    return sent_;
  }

 private:
  void move() {
    const double now = clock_.now();
    const double driven = std::max(0.0, std::min(now, expires_) - moved_until_);
    if (driven > 0.0) {
      Eigen::VectorXd next(3);
      model_.step(model_.state(pose_, command_), model_.input(command_), driven, next);
      pose_ = model_.pose(next);
    }
    if (now >= expires_) command_ = {};
    moved_until_ = now;
  }

  const Clock& clock_;
  const std::optional<double> dead_man_;
  const Unicycle model_;
  mutable std::mutex mutex_;
  Pose pose_;
  Twist command_;
  double expires_ = 0.0, moved_until_;
  bool connected_ = true;
  std::vector<std::string> faults_;
  int stops_ = 0;
  std::vector<std::pair<double, Twist>> sent_;
};

}  // namespace prospect::test
