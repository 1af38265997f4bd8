// SPDX-License-Identifier: Apache-2.0
#include "runtime/sensor_inbox.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <type_traits>
#include <utility>
#include <variant>

#include "models/formatted.h"
#include "models/knobs.h"
#include "models/robot_description.h"

namespace prospect {
namespace {

ClockOffsetOptions clock_of(bool in_runtime_clock, double drift) {
  ClockOffsetOptions options;
  options.own_clock = !in_runtime_clock;
  options.drift = drift;
  return options;
}

/// "1.25", for messages.
std::string seconds(double value) { return formatted("%.3g", value); }

bool empty(const Image& image) {
  return image.width <= 0 || image.height <= 0 ||
         image.pixels.size() !=
             static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}
bool empty(const std::shared_ptr<const Image>& image) { return !image || empty(*image); }
bool empty(const CameraContent& content) { return !content.estimate && empty(content.image); }

}  // namespace

SensorInboxOptions in_runtime_clock(SensorInboxOptions options) {
  options.cameras_in_runtime_clock = options.wheels_in_runtime_clock =
      options.depth_in_runtime_clock = options.scan_in_runtime_clock =
          options.poses_in_runtime_clock = options.imu_in_runtime_clock = true;
  return options;
}

std::string_view to_string(SensorStream stream) {
  switch (stream) {
    case SensorStream::kLeft:
      return "left image";
    case SensorStream::kRight:
      return "right image";
    case SensorStream::kPair:
      return "stereo pair";
    case SensorStream::kWheels:
      return "wheels";
    case SensorStream::kDepth:
      return "depth";
    case SensorStream::kScan:
      return "scan";
    case SensorStream::kPose:
      return "pose";
    case SensorStream::kImu:
      return "imu";
  }
  return "?";
}

std::string sensor_name(int sensor) { return "depth sensor " + std::to_string(sensor); }

SensorInbox::SensorInbox(const Clock& clock, const SensorInboxOptions& options)
    : clock_(clock),
      options_(options),
      cameras_(clock_of(options.cameras_in_runtime_clock, options.clock_drift)),
      wheels_(clock_of(options.wheels_in_runtime_clock, options.clock_drift)),
      depth_(clock_of(options.depth_in_runtime_clock, options.clock_drift)),
      scan_(clock_of(options.scan_in_runtime_clock, options.clock_drift)),
      poses_(clock_of(options.poses_in_runtime_clock, options.clock_drift)),
      imu_clock_(clock_of(options.imu_in_runtime_clock, options.clock_drift)),
      jumps_(options.pose_jump) {
  check_knobs("sensor inbox", options_);
}

ClockOffset& SensorInbox::offset_of(SensorStream stream) {
  switch (stream) {
    case SensorStream::kWheels:
      return wheels_;
    case SensorStream::kDepth:
      return depth_;
    case SensorStream::kScan:
      return scan_;
    case SensorStream::kPose:
      return poses_;
    case SensorStream::kImu:
      return imu_clock_;
    default:
      return cameras_;
  }
}

std::optional<double> SensorInbox::offset(const ClockOffset& of) const {
  std::optional<double> least = of.offset();
  if (!least || !options_.one_clock) return least;
  const auto include = [&](const ClockOffset& clock) {
    if (const auto one = clock.offset(); clock.has_own_clock() && one) {
      least = std::min(*least, *one);
    }
  };
  for (const ClockOffset* clock : {&cameras_, &wheels_, &depth_, &scan_, &poses_, &imu_clock_}) {
    include(*clock);
  }
  for (const auto& [number, sensor] : sensors_) include(sensor.clock);
  return least;
}

double SensorInbox::max_age(SensorStream stream) const {
  switch (stream) {
    case SensorStream::kWheels:
    case SensorStream::kImu:
      return options_.max_wheel_age;
    case SensorStream::kDepth:
    case SensorStream::kScan:
      return options_.max_range_age;
    default:
      return options_.max_image_age;
  }
}

void SensorInbox::drop(StreamCount& count, std::uint64_t StreamCount::*kind,
                       const std::string& why) {
  ++(count.*kind);
  count.reason = why;
}

std::optional<double> SensorInbox::shifted(SensorStream stream, double stamp) {
  return shifted(at(stream).count, offset_of(stream), stamp);
}

std::optional<double> SensorInbox::shifted(StreamCount& count, ClockOffset& offset, double stamp) {
  ++count.received;
  StampReading reading = offset.add(stamp, clock_.now());
  count.jumps = offset.jumps();
  count.offset = this->offset(offset);
  if (options_.one_clock && offset.has_own_clock() && reading.time) {
    reading.time = std::min(*reading.time, stamp + *count.offset);
  }
  if (!reading.time) {
    drop(count, &StreamCount::refused,
         "its stamp is " + std::string(to_string(reading.verdict)) +
             (reading.text.empty() ? "" : ": " + reading.text));
    return std::nullopt;
  }
  count.newest = std::max(count.newest.value_or(*reading.time), *reading.time);
  return reading.time;
}

void SensorInbox::put(SensorStream stream, SensorFrame frame) {
  const bool small = stream == SensorStream::kWheels || stream == SensorStream::kPose ||
                     stream == SensorStream::kImu;
  put(at(stream), small ? options_.wheel_capacity : options_.capacity, std::move(frame));
}

void SensorInbox::put(Stream& s, int capacity, SensorFrame frame) {
  if (s.frames.size() >= static_cast<std::size_t>(capacity)) {
    const auto oldest =
        std::min_element(s.frames.begin(), s.frames.end(),
                         [](const auto& a, const auto& b) { return stamp_of(a) < stamp_of(b); });
    s.frames.erase(oldest);
    drop(s.count, &StreamCount::overflown, "more came than were taken");
  }
  s.frames.push_back(std::move(frame));
}

void SensorInbox::pair_up(SensorStream stream) {
  const bool is_left = stream == SensorStream::kLeft;
  const Lone& one = (is_left ? left_ : right_).back();
  const Lone* partner = nullptr;
  double nearest = options_.pair_tolerance;
  for (const Lone& other : is_left ? right_ : left_) {
    const double apart = std::abs(one.stamp - other.stamp);
    if (apart > nearest || (partner && apart == nearest)) continue;
    if (!one.content.estimate != !other.content.estimate) continue;
    partner = &other;
    nearest = apart;
  }
  if (!partner) return;
  const Lone& left = is_left ? one : *partner;
  const Lone& right = is_left ? *partner : one;
  // How far they are apart their own clock knows best.
  const double left_stamp = left.stamp, right_stamp = right.stamp, time = left.time;
  SensorFrame pair =
      StereoFrame{time, time + (right_stamp - left_stamp), left.content.image, right.content.image};
  if (left.content.estimate) pair = EstimateFrame{time, left.content.estimate};
  const auto take_up_to = [&](std::deque<Lone>& waiting, double stamp, SensorStream stream) {
    StreamCount& count = at(stream).count;
    ++count.taken;
    std::erase_if(waiting, [&](const Lone& one) {
      if (one.stamp < stamp) drop(count, &StreamCount::unpaired, "no partner of its stamp came");
      return one.stamp <= stamp;
    });
  };
  take_up_to(left_, left_stamp, SensorStream::kLeft);
  take_up_to(right_, right_stamp, SensorStream::kRight);
  StreamCount& count = at(SensorStream::kPair).count;
  ++count.received;
  count.newest = std::max(count.newest.value_or(time), time);
  count.offset = cameras_.offset();
  pair_offset_ = right_stamp - left_stamp;
  put(SensorStream::kPair, std::move(pair));
}

void SensorInbox::lone(SensorStream stream, double stamp, CameraContent content) {
  {
    const std::lock_guard lock(mutex_);
    const std::optional<double> at_capture = shifted(stream, stamp);
    if (!at_capture) return;
    StreamCount& count = at(stream).count;
    if (empty(content)) return drop(count, &StreamCount::refused, "the image is empty");
    std::deque<Lone>& waiting = stream == SensorStream::kLeft ? left_ : right_;
    if (waiting.size() >= static_cast<std::size_t>(options_.capacity)) {
      waiting.pop_front();
      drop(count, &StreamCount::unpaired, "no partner of its stamp came");
    }
    waiting.push_back({stamp, *at_capture, std::move(content)});
    pair_up(stream);
  }
  came_.notify_one();
}

void SensorInbox::left(double stamp, CameraContent content) {
  lone(SensorStream::kLeft, stamp, std::move(content));
}

void SensorInbox::right(double stamp, CameraContent content) {
  lone(SensorStream::kRight, stamp, std::move(content));
}

void SensorInbox::observe(const SensorFrame& frame) {
  std::visit(
      [this](const auto& f) {
        using Frame = std::decay_t<decltype(f)>;
        if constexpr (std::is_same_v<Frame, WheelSample>) {
          wheels(f);
        } else if constexpr (std::is_same_v<Frame, EstimateFrame>) {
          left(f.stamp, f.belief);
          right(f.stamp, f.belief);
        } else {
          add(f);
        }
      },
      frame);
}

void SensorInbox::pair(double left_stamp, double right_stamp, ImagePair images) {
  add(StereoFrame{left_stamp, right_stamp, std::make_shared<const Image>(std::move(images.left)),
                  std::make_shared<const Image>(std::move(images.right))});
}

void SensorInbox::add(StereoFrame frame) {
  const double left_stamp = frame.left_stamp, right_stamp = frame.right_stamp;
  {
    const std::lock_guard lock(mutex_);
    const std::optional<double> at_capture = shifted(SensorStream::kPair, left_stamp);
    if (!at_capture) return;
    StreamCount& count = at(SensorStream::kPair).count;
    if (empty(frame.left) || empty(frame.right) || !std::isfinite(right_stamp)) {
      return drop(count, &StreamCount::refused,
                  "an image is empty or the right one's stamp is not finite");
    }
    pair_offset_ = right_stamp - left_stamp;
    frame.right_stamp += *at_capture - left_stamp;
    frame.left_stamp = *at_capture;
    put(SensorStream::kPair, std::move(frame));
  }
  came_.notify_one();
}

void SensorInbox::wheels(const WheelSample& sample) {
  {
    const std::lock_guard lock(mutex_);
    const std::optional<double> stamp = shifted(SensorStream::kWheels, sample.stamp);
    if (!stamp) return;
    WheelSample shifted_sample = sample;
    shifted_sample.stamp = *stamp;
    put(SensorStream::kWheels, shifted_sample);
  }
  came_.notify_one();
}

void SensorInbox::depth(double stamp, DepthImage image) {
  add(DepthFrame{stamp, std::make_shared<const DepthImage>(std::move(image))});
}

std::optional<SensorInbox::RangeSource> SensorInbox::range_source(SensorStream kind, int sensor) {
  if (sensor < 0 || sensor >= kMostDepthSensors) {
    drop(at(kind).count, &StreamCount::refused,
         "it is of sensor " + std::to_string(sensor) + "; expected 0 to " +
             std::to_string(kMostDepthSensors - 1));
    return std::nullopt;
  }
  if (sensor == 0) return RangeSource{at(kind), offset_of(kind), ranges_};
  const bool in_runtime_clock = kind == SensorStream::kDepth ? options_.depth_in_runtime_clock
                                                             : options_.scan_in_runtime_clock;
  const auto [found, is_new] = sensors_.try_emplace(
      sensor, Sensor{{}, ClockOffset(clock_of(in_runtime_clock, options_.clock_drift)), {}, kind});
  Sensor& of = found->second;
  return RangeSource{of.stream, of.clock, of.ranges};
}

template <class Frame, class Content>
void SensorInbox::add_ranges(SensorStream kind, Frame frame, Content Frame::*content,
                             const char* empty, Frame NewestRanges::*newest,
                             Frame NewestRanges::*before) {
  {
    const std::lock_guard lock(mutex_);
    const std::optional<RangeSource> source = range_source(kind, frame.sensor);
    if (!source) return;
    StreamCount& count = source->stream.count;
    const std::optional<double> at_capture = shifted(count, source->clock, frame.stamp);
    if (!at_capture) return;
    if (*empty != 0) return drop(count, &StreamCount::refused, empty);
    frame.stamp = *at_capture;
    Frame& last = source->ranges.*newest;
    if (!(last.*content) || frame.stamp >= last.stamp) {
      source->ranges.*before = std::exchange(last, frame);
    }
    put(source->stream, options_.capacity, std::move(frame));
  }
  came_.notify_one();
}

void SensorInbox::add(DepthFrame frame) {
  const bool whole = frame.image && frame.image->whole();
  add_ranges(SensorStream::kDepth, std::move(frame), &DepthFrame::image,
             whole ? "" : "the image is empty", &NewestRanges::depth, &NewestRanges::depth_before);
}

void SensorInbox::scan(double stamp, DepthScan in_B, std::shared_ptr<const Pose> pose) {
  add(ScanFrame{stamp, std::make_shared<const DepthScan>(std::move(in_B)), std::move(pose)});
}

void SensorInbox::add(ScanFrame frame) {
  const bool whole = frame.in_B != nullptr;
  add_ranges(SensorStream::kScan, std::move(frame), &ScanFrame::in_B,
             whole ? "" : "the scan is empty", &NewestRanges::scan, &NewestRanges::scan_before);
}

void SensorInbox::add(ExternalPose pose) {
  {
    const std::lock_guard lock(mutex_);
    const std::optional<double> at_capture = shifted(SensorStream::kPose, pose.stamp);
    if (!at_capture) return;
    pose.stamp = *at_capture;
    StreamCount& count = at(SensorStream::kPose).count;
    if (std::string jump = jumps_.add(pose); !jump.empty()) count.pose_jump = std::move(jump);
    count.pose_jumps = pose.jumps.count;
    put(SensorStream::kPose, std::move(pose));
  }
  came_.notify_one();
}

void SensorInbox::add(ImuSample sample) {
  const std::lock_guard lock(mutex_);
  if (!sample.finite()) {
    StreamCount& count = at(SensorStream::kImu).count;
    ++count.received;
    return drop(count, &StreamCount::refused, "a number that is not finite");
  }
  const std::optional<double> at_capture = shifted(SensorStream::kImu, sample.stamp);
  if (!at_capture) return;
  sample.stamp = *at_capture;
  if (imu_.empty() || sample.stamp > imu_.back().stamp) imu_.push_back(sample);
  if (imu_.size() > static_cast<std::size_t>(options_.wheel_capacity)) imu_.pop_front();
  put(SensorStream::kImu, std::move(sample));
}

std::vector<ImuSample> SensorInbox::imu_since(double stamp) const {
  const std::lock_guard lock(mutex_);
  auto first = imu_.end();
  while (first != imu_.begin() && std::prev(first)->stamp > stamp) --first;
  return {first, imu_.end()};
}

void SensorInbox::add(Correction correction) {
  {
    const std::lock_guard lock(mutex_);
    correction.stamp = clock_.now();
    if (corrections_.size() >= static_cast<std::size_t>(options_.capacity)) corrections_.pop_back();
    corrections_.push_back(std::move(correction));
  }
  came_.notify_one();
}

std::optional<SensorFrame> SensorInbox::take() {
  const std::lock_guard lock(mutex_);
  if (!corrections_.empty()) {
    SensorFrame correction = std::move(corrections_.front());
    corrections_.pop_front();
    return correction;
  }
  while (true) {
    Stream* from = nullptr;
    std::deque<SensorFrame>::iterator oldest;
    SensorStream which = SensorStream::kPair;
    const auto look = [&](Stream& s, SensorStream kind) {
      for (auto frame = s.frames.begin(); frame != s.frames.end(); ++frame) {
        if (from && !(stamp_of(*frame) < stamp_of(*oldest))) continue;
        from = &s;
        oldest = frame;
        which = kind;
      }
    };
    for (std::size_t k = 0; k < kSensorStreams; ++k) {
      look(streams_[k], static_cast<SensorStream>(k));
    }
    for (auto& [number, sensor] : sensors_) look(sensor.stream, sensor.kind);
    if (!from) return std::nullopt;
    SensorFrame frame = std::move(*oldest);
    from->frames.erase(oldest);
    const double age = clock_.now() - stamp_of(frame);
    if (which != SensorStream::kWheels && age > max_age(which)) {
      drop(from->count, &StreamCount::too_old, "it was " + seconds(age) + " s old");
      continue;
    }
    ++from->count.taken;
    return frame;
  }
}

bool SensorInbox::wait(double seconds, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto any = [&] {
    return !corrections_.empty() ||
           std::any_of(streams_.begin(), streams_.end(),
                       [&](const Stream& s) {
                         return !s.frames.empty() && &s != &at(SensorStream::kImu);
                       }) ||
           std::any_of(sensors_.begin(), sensors_.end(),
                       [](const auto& s) { return !s.second.stream.frames.empty(); });
  };
  return came_.wait_for(lock, stop, std::chrono::duration<double>(std::clamp(seconds, 0.0, 1e6)),
                        any);
}

NewestRanges SensorInbox::ranges(int sensor) const {
  const std::lock_guard lock(mutex_);
  if (sensor == 0) return ranges_;
  const auto at = sensors_.find(sensor);
  return at == sensors_.end() ? NewestRanges() : at->second.ranges;
}

std::optional<double> SensorInbox::pair_offset() const {
  const std::lock_guard lock(mutex_);
  return pair_offset_;
}

StreamCount SensorInbox::count_of_sensor(int sensor) const {
  const std::lock_guard lock(mutex_);
  const auto at = sensors_.find(sensor);
  return at == sensors_.end() ? StreamCount() : at->second.stream.count;
}

StreamCount SensorInbox::count(SensorStream stream) const {
  const std::lock_guard lock(mutex_);
  return streams_[static_cast<std::size_t>(stream)].count;
}

std::string SensorInbox::stale() const {
  const std::lock_guard lock(mutex_);
  const double now = clock_.now();
  const auto said = [&](const std::string& name, const std::optional<double>& newest,
                        double most) -> std::string {
    if (!newest || now - *newest <= most) return "";
    return name + ": the newest frame is " + seconds(now - *newest) + " s old; at most " +
           seconds(most) + " s";
  };
  std::string first;
  for (std::size_t k = 0; k < kSensorStreams && first.empty(); ++k) {
    const auto stream = static_cast<SensorStream>(k);
    first = said(std::string(to_string(stream)), streams_[k].count.newest, max_age(stream));
  }
  for (const auto& [number, sensor] : sensors_) {
    if (!first.empty()) break;
    first = said(sensor_name(number), sensor.stream.count.newest, options_.max_range_age);
  }
  return first;
}

}  // namespace prospect
