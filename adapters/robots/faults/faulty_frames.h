// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "adapters/robots/faults/injected_fault.h"
#include "perception/mapping/depth_image.h"
#include "runtime/clock.h"
#include "runtime/frame_sink.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// Stereo pairs, poses, depth images, scans and samples of an IMU of any robot on their way into an
/// inbox, with injected faults of cameras, depth sensor, IMU and their clock (injected_fault.h). A
/// pose from outside has the faults of both cameras. Without a fault of theirs they pass as they
/// are.
///
/// Thread-safety: any thread. Nothing throws after construction, but for want of memory.
class FaultyFrames final : public ImageSink {
 public:
  /// inbox and clock outlive it; the time of the faults begins at `start` [s]. `range` [m]: what
  /// depth:garbage lies in.
  FaultyFrames(const Clock& clock, SensorInbox& inbox, std::vector<InjectedFault> faults,
               double start, DepthRange range);

  /// As the inbox must take the frames: with a fault of their clock they are not in the runtime's.
  static SensorInboxOptions inbox_options(SensorInboxOptions options,
                                          const std::vector<InjectedFault>& faults);

  void observe(const SensorFrame& frame) override;
  void left(double stamp, CameraContent content) override;
  void right(double stamp, CameraContent content) override;

 private:
  struct Scan {
    DepthScan in_B;
    std::shared_ptr<const Pose> pose;
  };
  void depth(double stamp, DepthImage image);
  void scan(double stamp, Scan scan);
  template <class Content>
  struct Stream {
    std::optional<Content> newest;  // as sent last
    double stamp = 0.0;             // [s] that it had
    double sent = -1e9;             // [s]
    std::optional<double> ahead;    // [s] of its source's own clock; 0: it is the runtime's
    std::deque<std::pair<double, Content>> late;
  };
  bool holds(FaultSource source, FaultVerb verb, double time) const {
    return fault_at(faults_, source, verb, time) != nullptr;
  }
  bool any(std::initializer_list<FaultSource> sources) const;
  /// Calls send(stamp in the sensors' clock, content) for what of a stream is to be sent now: what
  /// the faults of its sources make late, rare or old. stamp: in the source's clock.
  template <class Content, class Send>
  void pass(std::initializer_list<FaultSource> sources, Stream<Content>& stream, double stamp,
            Content content, double now, const Send& send);
  void camera(FaultSource source, Stream<CameraContent>& stream, double stamp,
              CameraContent content, double now);
  void cameras(double stamp, CameraContent left, CameraContent right);
  void pose(const ExternalPose& measured);
  void imu(const ImuSample& measured);
  double any_range();  // [m]

  const Clock& clock_;
  SensorInbox& inbox_;
  const std::vector<InjectedFault> faults_;
  const double start_;
  const DepthRange range_;
  std::mutex mutex_;
  Stream<CameraContent> left_, right_;
  Stream<ExternalPose> pose_;
  Stream<DepthImage> depth_;
  Stream<Scan> scan_;
  Stream<ImuSample> imu_;
  std::uint64_t random_ = 1;
};

}  // namespace prospect
