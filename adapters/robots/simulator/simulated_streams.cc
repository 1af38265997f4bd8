// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/simulated_streams.h"

#include <type_traits>
#include <variant>

namespace prospect {
namespace {

void shift(Belief& belief, double by) {
  belief.stamp += by;
  belief.stamps.pose += by;
  belief.stamps.map += by;
  belief.stamps.landmarks += by;
  belief.stamps.ranges += by;
}

SensorFrame later(SensorFrame frame, double by) {
  std::visit(
      [by](auto& f) {
        if constexpr (std::is_same_v<std::decay_t<decltype(f)>, StereoFrame>) {
          f.left_stamp += by;
          f.right_stamp += by;
        } else {
          f.stamp += by;
        }
      },
      frame);
  return frame;
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

}  // namespace

SensorInboxOptions simulated_inbox(SensorInboxOptions options) {
  options.cameras_in_runtime_clock = options.depth_in_runtime_clock =
      options.scan_in_runtime_clock = options.imu_in_runtime_clock = true;
  return options;
}

SimulatedStreams::SimulatedStreams(SimulatedBase& base, Simulator& simulator, const Clock& clock,
                                   SensorInbox& inbox, FrameSink& frames, double period)
    : base_(base),
      simulator_(simulator),
      clock_(clock),
      inbox_(inbox),
      frames_(frames),
      period_(period),
      updated_(clock.now()) {
  simulator_.deliver_to(this);
  simulator_.leave_ranges();
}

SimulatedStreams::~SimulatedStreams() { simulator_.deliver_to(nullptr); }

void SimulatedStreams::observe(const SensorFrame& measured) {
  const SensorFrame frame = later(measured, base_.start());
  // What cameras and wheels have measured is in the estimate.
  if (std::holds_alternative<ScanFrame>(frame) || std::holds_alternative<DepthFrame>(frame) ||
      std::holds_alternative<ImuSample>(frame)) {
    frames_.observe(frame);
  }
  // Before the image of its time, which is held against it.
  if (std::holds_alternative<ImuSample>(frame)) take_frames();
  tell(observers_, &MissionObserver::on_frame, frame);
}

void SimulatedStreams::take_frames() {
  while (const std::optional<SensorFrame> frame = inbox_.take()) {
    const auto* pair = std::get_if<EstimateFrame>(&*frame);
    if (!pair) {
      simulator_.enter(stamp_of(*frame) - base_.start(), *frame);
      continue;
    }
    of_cameras_ = *pair->belief;
    const double later = pair->stamp - of_cameras_->stamps.pose;
    of_cameras_->stamps.pose += later;
    of_cameras_->stamps.landmarks += later;
  }
}

std::shared_ptr<const Belief> SimulatedStreams::update(const std::stop_token& stop) {
  if (!clock_.wait_until(updated_ + period_, stop)) return nullptr;
  updated_ = clock_.now();
  base_.advance(updated_);
  take_frames();
  auto made = std::make_shared<Belief>(*simulator_.sense());
  shift(*made, base_.start());
  frames_.observe(EstimateFrame{made->stamps.pose, made});
  take_frames();
  if (!of_cameras_) return nullptr;
  auto known = std::make_shared<Belief>(*made);
  take_cameras(*of_cameras_, *known);
  known->stamp = known->stamps.pose;
  return known;
}

}  // namespace prospect
