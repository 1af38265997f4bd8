#include "adapters/simulator/simulated_streams.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

namespace prospect {
namespace {

constexpr double kRemembered = 2.0 * kFaultDelay;  // [s] of beliefs

SensorInboxOptions inbox_options(const std::vector<InjectedFault>& faults) {
  SensorInboxOptions options;
  options.cameras_in_runtime_clock = options.depth_in_runtime_clock = !has_sensors_clock(faults);
  return options;
}

/// A number as four pixels.
Image picture_of(std::uint32_t number) {
  Image image(4, 1);
  for (int k = 0; k < 4; ++k) image.at(k, 0) = static_cast<std::uint8_t>(number >> (8 * k));
  return image;
}
std::uint32_t number_in(const Image& image) {
  std::uint32_t number = 0;
  for (int k = 0; k < 4; ++k) number |= static_cast<std::uint32_t>(image.at(k, 0)) << (8 * k);
  return number;
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

SimulatedStreams::SimulatedStreams(const Clock& clock, std::vector<InjectedFault> faults,
                                   double start)
    : clock_(clock),
      faults_(std::move(faults)),
      start_(start),
      inbox_(clock, inbox_options(faults_)) {}

std::optional<SimulatedStreams::Frame> SimulatedStreams::next(Stream& stream, FaultSource source,
                                                              double now, double time,
                                                              double SourceStamps::*capture) const {
  const bool camera = source == FaultSource::kLeftCamera || source == FaultSource::kRightCamera;
  const auto has = [&](FaultVerb verb) {
    return holds(source, verb, time) || (camera && holds(FaultSource::kCameras, verb, time));
  };
  if (has(FaultVerb::kOff) || off_at_times(faults_, source, kOnOff, time) ||
      (camera && off_at_times(faults_, FaultSource::kCameras, kOnOff, time))) {
    return std::nullopt;
  }
  if (has(FaultVerb::kSlow) && now - stream.time < kSlowFrames) return std::nullopt;
  if (has(FaultVerb::kStuck) && stream.newest) {
    // One camera that hangs gives its newest image once more; two, or a depth sensor, whose driver
    // stamps what it reads, give old data with new stamps.
    const bool old_stamp = camera && !holds(FaultSource::kCameras, FaultVerb::kStuck, time);
    return Frame{*stream.newest,
                 old_stamp ? stream.stamp : sensors_clock(faults_, start_, now, time)};
  }
  const Made* newest = nullptr;
  for (const Made& one : made_) {
    if (!has(FaultVerb::kDelayed) || one.belief.stamp <= now - kFaultDelay) newest = &one;
  }
  if (!newest) return std::nullopt;
  const double stamp = sensors_clock(faults_, start_, newest->belief.stamps.*capture, time);
  // A scan is there once; images come with each belief.
  if (!camera && stream.newest && stamp == stream.stamp) return std::nullopt;
  return Frame{newest->number, stamp};
}

void SimulatedStreams::send_image(FaultSource source, Stream& stream, double now, double time) {
  const std::optional<Frame> frame = next(stream, source, now, time, &SourceStamps::pose);
  if (!frame) return;
  stream = {frame->number, frame->stamp, now};
  const bool empty = holds(source, FaultVerb::kGarbage, time) ||
                     holds(FaultSource::kCameras, FaultVerb::kGarbage, time);
  const double skew = holds(source, FaultVerb::kWrong, time) ? kCameraSkew : 0.0;
  Image image = empty ? Image() : picture_of(frame->number);
  if (source == FaultSource::kLeftCamera) {
    inbox_.left(frame->stamp - skew, std::move(image));
  } else {
    inbox_.right(frame->stamp - skew, std::move(image));
  }
}

void SimulatedStreams::send_depth(double now, double time) {
  const std::optional<Frame> frame =
      next(depth_, FaultSource::kDepth, now, time, &SourceStamps::ranges);
  if (!frame) return;
  depth_ = {frame->number, frame->stamp, now};
  // Numbers up to 2^24 are exact as depths: at 20 Hz those of ten days.
  inbox_.depth(frame->stamp, DepthImage(1, 1, static_cast<float>(frame->number)));
}

const Belief* SimulatedStreams::made(std::uint32_t number) const {
  for (const Made& one : made_) {
    if (one.number == number) return &one.belief;
  }
  return nullptr;
}

std::optional<Belief> SimulatedStreams::through(Belief belief) {
  const double now = clock_.now(), time = now - start_;
  made_.push_back({++number_, belief});
  while (made_.front().belief.stamp < now - kRemembered && made_.size() > 1) made_.pop_front();
  send_image(FaultSource::kLeftCamera, left_, now, time);
  send_image(FaultSource::kRightCamera, right_, now, time);
  send_depth(now, time);
  while (const std::optional<SensorFrame> frame = inbox_.take()) {
    if (const auto* pair = std::get_if<StereoFrame>(&*frame)) {
      const std::uint32_t number = number_in(*pair->left);
      // What is not remembered is the picture that came last, once more.
      if (const Belief* content = made(number)) of_cameras_ = *content;
      if (!of_cameras_) continue;
      const double shift = pair->left_stamp - of_cameras_->stamps.pose;
      of_cameras_->stamps.pose += shift;
      of_cameras_->stamps.landmarks += shift;
    } else if (const auto* scan = std::get_if<DepthFrame>(&*frame)) {
      const auto number = static_cast<std::uint32_t>(scan->image->at(0, 0));
      if (const Belief* content = made(number)) of_depth_ = *content;
      if (!of_depth_) continue;
      of_depth_->stamps.map = of_depth_->stamps.ranges = scan->stamp;
    }
  }
  if (!of_cameras_) return std::nullopt;
  Belief known = std::move(belief);
  take_cameras(*of_cameras_, known);
  if (of_depth_) {
    take_depth(*of_depth_, known);
  } else {  // nothing has come since the start
    known.stamps.map = known.stamps.ranges = start_;
  }
  known.stamp = known.stamps.pose;
  return known;
}

}  // namespace prospect
