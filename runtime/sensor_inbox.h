// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "models/image.h"
#include "runtime/clock.h"
#include "runtime/clock_offset.h"
#include "runtime/image_sink.h"
#include "runtime/pose_jump.h"
#include "runtime/sensor_frame.h"

namespace prospect {

class Knobs;

/// Where frames come from. Left and right are the images of a stereo camera that come one by one.
enum class SensorStream { kLeft, kRight, kPair, kWheels, kDepth, kScan, kPose, kImu };
inline constexpr std::size_t kSensorStreams = 8;
std::string_view to_string(SensorStream stream);
/// Of a depth sensor from 1 on: "depth sensor 1".
std::string sensor_name(int sensor);

/// The newest raw ranges, and those before them, for who looks at them without perception. Null:
/// none has come so far.
struct NewestRanges {
  DepthFrame depth, depth_before;
  ScanFrame scan, scan_before;
};

struct SensorInboxOptions {
  double pair_tolerance = 0.005;  ///< [s] between the stamps of a left and a right image of a pair
  /// Frames of each stream that wait; beyond, the oldest is dropped.
  int capacity = 8;
  int wheel_capacity = 200;  ///< likewise of samples of wheels and an IMU, and of poses
  /// A frame that is older than this when it is taken, from capture on, is dropped, and a stream
  /// whose newest frame is older is stale [s]. Infinite: any age. Wheel samples are taken at any
  /// age: without one of them the way that it tells of is missing from the pose.
  double max_image_age = 0.5;  ///< also of poses
  double max_wheel_age = 0.5;  ///< also of samples of an IMU
  double max_range_age = 1.0;  ///< of depth images and scans, of each depth sensor by itself
  /// Stamps are those of the runtime's clock already, as where the driver stamps what it receives
  /// from the kernel; else they are the source's own and are shifted into it. One choice for the
  /// cameras of a pair, whose clock must be one: images are paired by their own stamps.
  bool cameras_in_runtime_clock = false;
  bool wheels_in_runtime_clock = false;
  bool depth_in_runtime_clock = false;
  bool scan_in_runtime_clock = false;
  bool poses_in_runtime_clock = false;
  bool imu_in_runtime_clock = false;
  /// Clocks of their own are one and the same: of the offsets that streams show, each with the
  /// least delay of its own, the least holds for all. So a stream that is always late, as poses of
  /// a localization are, is not taken for one of a clock that is behind.
  bool one_clock = false;
  /// Most by which the clock of a source runs faster or slower than the runtime's [s/s]
  /// (ClockOffsetOptions::drift). Clocks of hardware stay below the default; the time of a
  /// simulator that does not keep up with the wall clock does not.
  double clock_drift = 1e-4;
  PoseJumpOptions pose_jump;  ///< of poses from outside
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, SensorInboxOptions& options);
/// With stamps of all sources in the runtime's clock, as where a simulation tells both.
SensorInboxOptions in_runtime_clock(SensorInboxOptions options);

/// What became of the frames of a stream. All that came = waiting + taken + dropped of each kind.
struct StreamCount {
  std::uint64_t received = 0;
  std::uint64_t taken = 0;       ///< by perception; a left or right image with its pair
  std::uint64_t overflown = 0;   ///< dropped: too many waited
  std::uint64_t too_old = 0;     ///< dropped: older than the limit when it was to be taken
  std::uint64_t unpaired = 0;    ///< dropped: an image whose partner did not come
  std::uint64_t refused = 0;     ///< dropped: a stamp that has no time, or an empty image
  int jumps = 0;                 ///< of its clock, or of the runtime's against it
  std::optional<double> newest;  ///< stamp of the newest frame [s], in the runtime's clock
  /// [s] that the runtime's clock is ahead of the stream's (ClockOffset); none: not settled.
  std::optional<double> offset;
  std::string reason;     ///< why the newest that was dropped was
  int pose_jumps = 0;     ///< of poses (PoseJumpWatch)
  std::string pose_jump;  ///< the newest of them
};

/// Where sensor adapters put what they receive, from any thread, and perception takes it from, in
/// one. Bounded: whoever is slow, memory is not used up, and the newest is what is kept.
///
/// Stereo. Images that come one by one are paired by stamp, never by sequence: a left and a right
/// image whose stamps differ by at most pair_tolerance; of several the nearest. What is older than
/// a pair that was made has lost its partner and is dropped. A pair that comes whole is taken as it
/// is; its two stamps stand in it, and perception judges them. Models of cameras are paired in the
/// same way; the left one's estimate is the pair's.
///
/// Order. take() gives the frame with the oldest stamp of those that wait. It waits for no stream:
/// perception takes inputs in any order among its sources. Samples of an IMU wake nobody: they are
/// taken along.
///
/// Clock. now() of the runtime's clock when a frame is put in is its arrival. A stream with a clock
/// of its own is shifted by an estimate of the offset, from stamps and arrivals (clock_offset.h);
/// what comes before that has settled, or after a jump, has no time and is refused.
///
/// Thread-safety: any thread, but take() and wait() are for one. No lock is held for longer than a
/// frame is moved. Never throws after construction; the constructor throws std::invalid_argument on
/// options out of range.
class SensorInbox final : public ImageSink {
 public:
  SensorInbox(const Clock& clock, const SensorInboxOptions& options);

  /// A pair, wheel motion, ranges, a pose, or an estimate, which counts as both images of its pair.
  /// A correction is of the time at which it comes, and of no stream; beyond the capacity it takes
  /// the place of the newest.
  void observe(const SensorFrame& frame) override;
  void left(double stamp, CameraContent content) override;
  void right(double stamp, CameraContent content) override;
  void pair(double left_stamp, double right_stamp, ImagePair images);
  void wheels(const WheelSample& sample);
  void depth(double stamp, DepthImage image);
  void scan(double stamp, DepthScan in_B, std::shared_ptr<const Pose> pose = nullptr);

  /// The oldest frame that waits and is not too old; none: nothing waits.
  std::optional<SensorFrame> take();
  /// Waits until a frame waits, at most for that many seconds of wall time. False: none came, or
  /// `stop` was requested.
  bool wait(double seconds, const std::stop_token& stop);

  /// The newest ranges of a depth sensor, whether taken by perception or not.
  NewestRanges ranges(int sensor = 0) const;
  /// The newest samples of an IMU, those after a stamp [s], oldest first, whether taken or not.
  std::vector<ImuSample> imu_since(double stamp) const;
  /// Capture of the right image - capture of the left one of the newest pair [s]; none so far.
  std::optional<double> pair_offset() const;
  StreamCount count(SensorStream stream) const;
  /// Of all that a depth sensor has delivered; from 1 on.
  StreamCount count_of_sensor(int sensor) const;
  /// Of streams that have delivered anything: the first whose newest frame is too old, "depth: the
  /// newest frame is 1.2 s old; at most 1.0 s"; empty: none.
  std::string stale() const;

 private:
  struct Lone {          // an image that waits for its partner
    double stamp = 0.0;  // [s] in the cameras' clock
    double time = 0.0;   // [s] in the runtime's
    CameraContent content;
  };
  struct Stream {
    StreamCount count;
    std::deque<SensorFrame> frames;  // empty for kLeft and kRight
  };

  /// A depth sensor besides the first: a source of its own, with a clock of its own.
  struct Sensor {
    Stream stream;
    ClockOffset clock;
    NewestRanges ranges;
    SensorStream kind = SensorStream::kScan;
  };

  Stream& at(SensorStream stream) { return streams_[static_cast<std::size_t>(stream)]; }
  double max_age(SensorStream stream) const;
  /// The stamp in the runtime's clock; none, counted: it is not finite.
  std::optional<double> shifted(SensorStream stream, double stamp);
  std::optional<double> shifted(StreamCount& count, ClockOffset& clock, double stamp);
  void lone(SensorStream stream, double stamp, CameraContent content);
  /// Makes a pair of the newest image of a stream, if its partner is there.
  void pair_up(SensorStream stream);
  void put(SensorStream stream, SensorFrame frame);
  void put(Stream& to, int capacity, SensorFrame frame);
  /// Where the ranges of a depth sensor go.
  struct RangeSource {
    Stream& stream;
    ClockOffset& clock;
    NewestRanges& ranges;
  };
  /// None, counted: there is no such sensor.
  std::optional<RangeSource> range_source(SensorStream kind, int sensor);
  /// empty: why the frame is refused; "": it is not.
  template <class Frame, class Content>
  void add_ranges(SensorStream kind, Frame frame, Content Frame::*content, const char* empty,
                  Frame NewestRanges::*newest, Frame NewestRanges::*before);
  ClockOffset& offset_of(SensorStream stream);
  /// [s] that the runtime's clock is ahead of a stream's; none: not settled.
  std::optional<double> offset(const ClockOffset& clock) const;
  void add(StereoFrame frame);
  void add(DepthFrame frame);
  void add(ScanFrame frame);
  void add(ExternalPose pose);
  void add(ImuSample sample);
  void add(Correction correction);
  static void drop(StreamCount& count, std::uint64_t StreamCount::*kind, const std::string& why);

  const Clock& clock_;
  const SensorInboxOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable_any came_;
  std::array<Stream, kSensorStreams> streams_;
  std::deque<Lone> left_, right_;  // in order of arrival
  std::deque<Correction> corrections_;
  NewestRanges ranges_;
  std::deque<ImuSample> imu_;      // the newest, by stamp
  std::map<int, Sensor> sensors_;  // from 1 on, of those that have delivered anything
  std::optional<double> pair_offset_;
  // The cameras have one clock.
  ClockOffset cameras_, wheels_, depth_, scan_, poses_, imu_clock_;
  PoseJumpWatch jumps_;
};

}  // namespace prospect
