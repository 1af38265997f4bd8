#include "adapters/robots/simulator/simulated_streams.h"

#include <utility>
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
      options.scan_in_runtime_clock = true;
  return options;
}

SimulatedStreams::SimulatedStreams(SimulatedBase& base, Simulator& simulator, const Clock& clock,
                                   SensorInbox& inbox, SimulatedFrames frames, double period,
                                   SensorTap listeners)
    : base_(base),
      simulator_(simulator),
      clock_(clock),
      inbox_(inbox),
      frames_(std::move(frames)),
      period_(period),
      listeners_(std::move(listeners)),
      updated_(clock.now()) {
  const double epoch = base.start();
  SensorTap tap;
  tap.scan = [this, epoch](double stamp, const DepthScan& in_B) {
    frames_.scan(epoch + stamp, in_B, simulator_.estimated_pose());
    if (listeners_.scan) listeners_.scan(epoch + stamp, in_B);
  };
  tap.depth = [this, epoch](double stamp, const DepthImage& depth) {
    frames_.depth(epoch + stamp, depth);
    if (listeners_.depth) listeners_.depth(epoch + stamp, depth);
  };
  tap.pair = [this, epoch](double stamp, const ImagePair& pair) {
    if (listeners_.pair) listeners_.pair(epoch + stamp, pair);
  };
  tap.wheels = [this, epoch](WheelSample sample) {
    sample.stamp += epoch;
    if (listeners_.wheels) listeners_.wheels(sample);
  };
  simulator_.set_tap(std::move(tap));
  simulator_.leave_ranges();
}

SimulatedStreams::~SimulatedStreams() { simulator_.set_tap({}); }

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
  frames_.pair(made->stamps.pose, made);
  take_frames();
  if (!of_cameras_) return nullptr;
  auto known = std::make_shared<Belief>(*made);
  take_cameras(*of_cameras_, *known);
  known->stamp = known->stamps.pose;
  return known;
}

}  // namespace prospect
