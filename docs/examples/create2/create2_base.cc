// SPDX-License-Identifier: Apache-2.0
#include "create2_base.h"

namespace prospect {

Create2Base::Create2Base(const Create2Options& options) : options_(options), relay_(options) {}

BaseLimits Create2Base::limits() const {
  BaseLimits limits;
  limits.speed = kCreate2WheelSpeed;
  limits.yaw_rate = 2.0 * kCreate2WheelSpeed / kCreate2WheelBase;
  return limits;  // how it accelerates its maker does not say
}

void Create2Base::send(const Twist& command, double expires) { relay_.send(command, expires); }

// A relay that gets zero velocity for a while holds it anyway.
void Create2Base::stop() { relay_.send({}, SteadyClock().now() + 1.0); }

void Create2Base::add(const Create2Relay::Word& word, BaseReport& report) {
  unplugged_ = unplugged_ || word.unplugged;
  if (word.unplugged) return;
  speaks_ = true;
  stamp_ = word.stamp;
  faults_ = faults_of(word.sensors);
  if (!counted_) counted_ = word;
  const double time = word.stamp - counted_->stamp;
  if (time < kWindow) return;
  const double left =
      kCreate2Count * counts_between(counted_->sensors.left_count, word.sensors.left_count);
  const double right =
      kCreate2Count * counts_between(counted_->sensors.right_count, word.sensors.right_count);
  WheelSample sample;
  sample.stamp = word.stamp;
  sample.velocity.x() = 0.5 * (left + right) / time;
  sample.yaw_rate = (right - left) / (kCreate2WheelBase * time);
  report.wheels.push_back(sample);
  velocity_ = {{sample.velocity.x(), 0.0, 0.0}, sample.yaw_rate};
  counted_ = word;
}

BaseReport Create2Base::report() {
  BaseReport report;
  for (const Create2Relay::Word& word : relay_.newest()) add(word, report);
  report.connected = speaks_ && !unplugged_ && !relay_.ended();
  report.stamp = stamp_;
  report.velocity = velocity_;
  report.faults = faults_;
  if (unplugged_) {
    report.faults.emplace_back("its cable is unplugged: what it was told last it may still do");
  } else if (relay_.ended()) {
    report.faults.emplace_back("its relay has ended: nothing stops it when commands cease");
  }
  return report;
}

}  // namespace prospect
