// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/faults/faulty_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/mixed_bits.h"

namespace prospect {

FaultyFrames::FaultyFrames(const Clock& clock, SensorInbox& inbox,
                           std::vector<InjectedFault> faults, double start, DepthRange range)
    : clock_(clock), inbox_(inbox), faults_(std::move(faults)), start_(start), range_(range) {}

SensorInboxOptions FaultyFrames::inbox_options(SensorInboxOptions options,
                                               const std::vector<InjectedFault>& faults) {
  if (has_sensors_clock(faults)) {
    options.cameras_in_runtime_clock = options.depth_in_runtime_clock =
        options.scan_in_runtime_clock = options.poses_in_runtime_clock =
            options.imu_in_runtime_clock = false;
  }
  return options;
}

bool FaultyFrames::any(std::initializer_list<FaultSource> sources) const {
  return std::any_of(sources.begin(), sources.end(),
                     [&](FaultSource source) { return has_source(faults_, source); });
}

template <class Content, class Send>
void FaultyFrames::pass(std::initializer_list<FaultSource> sources, Stream<Content>& stream,
                        double stamp, Content content, double now, const Send& send) {
  const double time = now - start_;
  // No frame is as old as that when it comes.
  constexpr double kOneClock = 10.0;  // [s]
  if (!stream.ahead) stream.ahead = std::abs(stamp - now) < kOneClock ? 0.0 : stamp - now;
  const auto told_by_sensors = [&](double at) {
    return sensors_clock(faults_, start_, at - *stream.ahead, time) + *stream.ahead;
  };
  const auto has = [&](FaultVerb verb) {
    return std::any_of(sources.begin(), sources.end(),
                       [&](FaultSource source) { return holds(source, verb, time); });
  };
  const auto put = [&](double at, Content what) {
    stream.newest = what;
    stream.stamp = at;
    stream.sent = now;
    send(at, std::move(what));
  };
  if (has(FaultVerb::kDelayed)) {
    stream.late.emplace_back(stamp, std::move(content));
    while (!stream.late.empty() && stream.late.front().first - *stream.ahead <= now - kFaultDelay) {
      put(told_by_sensors(stream.late.front().first), std::move(stream.late.front().second));
      stream.late.pop_front();
    }
    return;
  }
  stream.late.clear();
  const bool off_now = std::any_of(sources.begin(), sources.end(), [&](FaultSource source) {
    return off_at_times(faults_, source, kOnOff, time);
  });
  if (has(FaultVerb::kOff) || off_now ||
      (has(FaultVerb::kSlow) && now - stream.sent < kSlowFrames)) {
    return;
  }
  const double told = told_by_sensors(stamp);
  if (!has(FaultVerb::kStuck) || !stream.newest) return put(told, std::move(content));
  // One camera of a pair that hangs gives its newest image once more; two, or a depth sensor, whose
  // driver stamps what it reads, give old data with new stamps.
  const FaultSource own = *sources.begin();
  const bool old_stamp = (own == FaultSource::kLeftCamera || own == FaultSource::kRightCamera) &&
                         !holds(FaultSource::kCameras, FaultVerb::kStuck, time);
  put(old_stamp ? stream.stamp : told, *stream.newest);
}

void FaultyFrames::camera(FaultSource source, Stream<CameraContent>& stream, double stamp,
                          CameraContent content, double now) {
  const double time = now - start_;
  pass({source, FaultSource::kCameras}, stream, stamp, std::move(content), now,
       [&](double told, CameraContent seen) {
         if (holds(source, FaultVerb::kGarbage, time) ||
             holds(FaultSource::kCameras, FaultVerb::kGarbage, time)) {
           seen = CameraContent();
         }
         if (holds(source, FaultVerb::kWrong, time)) told -= kCameraSkew;
         if (source == FaultSource::kLeftCamera) {
           inbox_.left(told, std::move(seen));
         } else {
           inbox_.right(told, std::move(seen));
         }
       });
}

void FaultyFrames::observe(const SensorFrame& frame) {
  const bool of_depth = any({FaultSource::kDepth, FaultSource::kClock});
  const bool of_cameras = any({FaultSource::kLeftCamera, FaultSource::kRightCamera,
                               FaultSource::kCameras, FaultSource::kClock});
  const auto* const image = std::get_if<DepthFrame>(&frame);
  const auto* const rays = std::get_if<ScanFrame>(&frame);
  if ((image && image->sensor != 0) || (rays && rays->sensor != 0)) {
    SensorFrame told = frame;
    const double time = clock_.now() - start_;
    std::visit(
        [&](auto& f) {
          if constexpr (requires { f.stamp; }) {
            f.stamp = sensors_clock(faults_, start_, f.stamp, time);
          }
        },
        told);
    inbox_.observe(told);
  } else if (image && of_depth) {
    depth(image->stamp, *image->image);
  } else if (rays && of_depth) {
    scan(rays->stamp, {*rays->in_B, rays->pose});
  } else if (const auto* pair = std::get_if<StereoFrame>(&frame); pair && of_cameras) {
    cameras(pair->left_stamp, CameraContent(pair->left), CameraContent(pair->right));
  } else if (const auto* estimate = std::get_if<EstimateFrame>(&frame); estimate && of_cameras) {
    const CameraContent content(estimate->belief);
    cameras(estimate->stamp, content, content);
  } else if (const auto* measured = std::get_if<ExternalPose>(&frame); measured && of_cameras) {
    pose(*measured);
  } else if (const auto* sample = std::get_if<ImuSample>(&frame);
             sample && any({FaultSource::kImu, FaultSource::kClock})) {
    imu(*sample);
  } else {
    inbox_.observe(frame);
  }
}

void FaultyFrames::left(double stamp, CameraContent content) {
  const std::lock_guard lock(mutex_);
  camera(FaultSource::kLeftCamera, left_, stamp, std::move(content), clock_.now());
}

void FaultyFrames::right(double stamp, CameraContent content) {
  const std::lock_guard lock(mutex_);
  camera(FaultSource::kRightCamera, right_, stamp, std::move(content), clock_.now());
}

void FaultyFrames::cameras(double stamp, CameraContent left, CameraContent right) {
  const std::lock_guard lock(mutex_);
  const double now = clock_.now();
  camera(FaultSource::kLeftCamera, left_, stamp, std::move(left), now);
  camera(FaultSource::kRightCamera, right_, stamp, std::move(right), now);
}

void FaultyFrames::pose(const ExternalPose& measured) {
  const std::lock_guard lock(mutex_);
  const double now = clock_.now(), time = now - start_;
  pass({FaultSource::kCameras}, pose_, measured.stamp, measured, now,
       [&](double told, ExternalPose pose) {
         pose.stamp = told;
         if (holds(FaultSource::kCameras, FaultVerb::kGarbage, time)) {
           pose.T_WB.translation().setConstant(std::numeric_limits<double>::quiet_NaN());
         }
         inbox_.observe(pose);
       });
}

void FaultyFrames::imu(const ImuSample& measured) {
  const std::lock_guard lock(mutex_);
  const double now = clock_.now(), time = now - start_;
  pass({FaultSource::kImu}, imu_, measured.stamp, measured, now,
       [&](double told, ImuSample sample) {
         sample.stamp = told;
         if (holds(FaultSource::kImu, FaultVerb::kWrong, time)) {
           sample.angular_velocity += sample.R_BS.conjugate() * Eigen::Vector3d(0.0, 0.0, kGyroOff);
         }
         if (holds(FaultSource::kImu, FaultVerb::kGarbage, time)) {
           sample.angular_velocity.setConstant(std::numeric_limits<double>::quiet_NaN());
         }
         inbox_.observe(sample);
       });
}

double FaultyFrames::any_range() {
  const double share = unit_interval(mixed_bits(random_++));
  return range_.min + share * (range_.max - range_.min);
}

void FaultyFrames::depth(double stamp, DepthImage image) {
  const std::lock_guard lock(mutex_);
  const double now = clock_.now(), time = now - start_;
  pass({FaultSource::kDepth}, depth_, stamp, std::move(image), now,
       [&](double told, DepthImage picture) {
         if (holds(FaultSource::kDepth, FaultVerb::kWrong, time)) {
           for (float& z : picture.depth) z *= static_cast<float>(kDepthScale);
         }
         if (holds(FaultSource::kDepth, FaultVerb::kGarbage, time)) {
           for (float& z : picture.depth) z = static_cast<float>(any_range());
         }
         inbox_.depth(told, std::move(picture));
       });
}

void FaultyFrames::scan(double stamp, Scan measured) {
  const std::lock_guard lock(mutex_);
  const double now = clock_.now(), time = now - start_;
  pass({FaultSource::kDepth}, scan_, stamp, std::move(measured), now, [&](double told, Scan scan) {
    DepthScan& rays = scan.in_B;
    if (holds(FaultSource::kDepth, FaultVerb::kWrong, time)) {
      for (auto& hit : rays.hits) hit = rays.origin + kDepthScale * (hit - rays.origin);
    }
    if (holds(FaultSource::kDepth, FaultVerb::kGarbage, time)) {
      // Each ray ends anywhere.
      rays.hits.insert(rays.hits.end(), rays.misses.begin(), rays.misses.end());
      rays.misses.clear();
      for (auto& hit : rays.hits) {
        hit = rays.origin + any_range() * (hit - rays.origin).normalized();
      }
    }
    inbox_.scan(told, std::move(rays), std::move(scan.pose));
  });
}

}  // namespace prospect
