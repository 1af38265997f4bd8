// SPDX-License-Identifier: Apache-2.0
#include "runtime/range_check.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "models/robot_description.h"

namespace prospect {

RangeFrame range_frame(const DepthFrame& depth, const RangeCamera& c) {
  RangeFrame frame;
  frame.stamp = depth.stamp;
  frame.origin = c.mount.T_BC.translation();
  const DepthImage& image = *depth.image;
  if (!image.whole() || image.width != c.camera.width || image.height != c.camera.height) {
    return frame;
  }
  const int stride = std::max(1, c.stride);
  for (int v = stride / 2; v < image.height; v += stride) {
    for (int u = stride / 2; u < image.width; u += stride) {
      const Eigen::Vector3d direction((u - c.camera.cx) / c.camera.fx,
                                      (v - c.camera.cy) / c.camera.fy, 1.0);
      const double z = image.at(u, v);
      RangeRay ray;
      if (c.range.holds(z)) {
        ray.kind = RangeRay::Kind::kHit;
      } else if (z > c.range.max) {
        ray.kind = RangeRay::Kind::kClear;
      }
      const double along = ray.kind == RangeRay::Kind::kHit ? z : c.range.max;
      ray.point = c.mount.T_BC * (along * direction);
      frame.rays.push_back(ray);
    }
  }
  return frame;
}

RangeFrame range_frame(const ScanFrame& scan) {
  RangeFrame frame;
  frame.stamp = scan.stamp;
  frame.origin = scan.in_B->origin;
  for (const Eigen::Vector3d& point : scan.in_B->hits) {
    frame.rays.push_back({point, RangeRay::Kind::kHit});
  }
  for (const Eigen::Vector3d& point : scan.in_B->misses) {
    frame.rays.push_back({point, RangeRay::Kind::kClear});
  }
  return frame;
}

std::function<RangeCheck(const Twist&, double)> range_check(const SensorInbox& inbox,
                                                            const RangeStop& stop,
                                                            const RangeCameras& cameras) {
  return [&](const Twist& command, double now) {
    std::vector<RangeStopVerdict> verdicts;
    const auto shows_nothing = [](const RangeStopVerdict& verdict) {
      return verdict.reason == RangeStopReason::kTooFewRanges ||
             verdict.reason == RangeStopReason::kOutOfView;
    };
    const auto ask = [&](const RangeFrame& frame, const RangeFrame& before) {
      RangeStopVerdict verdict = stop.check(frame, command, now);
      if (shows_nothing(verdict) && !before.rays.empty()) {
        const RangeStopVerdict then = stop.check(before, command, now);
        if (then.share > verdict.share) verdict = then;
      }
      verdicts.push_back(std::move(verdict));
    };
    for (int sensor = 0; sensor < kMostDepthSensors; ++sensor) {
      const NewestRanges newest = inbox.ranges(sensor);
      const auto camera = cameras.find(sensor);
      if (newest.depth.image && camera != cameras.end()) {
        ask(range_frame(newest.depth, camera->second),
            newest.depth_before.image ? range_frame(newest.depth_before, camera->second)
                                      : RangeFrame());
      }
      if (newest.scan.in_B) {
        ask(range_frame(newest.scan),
            newest.scan_before.in_B ? range_frame(newest.scan_before) : RangeFrame());
      }
    }
    const auto out_of_view = [](const RangeStopVerdict& verdict) {
      return verdict.reason == RangeStopReason::kOutOfView;
    };
    const bool looked_at = !std::all_of(verdicts.begin(), verdicts.end(), out_of_view);
    RangeCheck look;
    for (const RangeStopVerdict& verdict : verdicts) {
      if (looked_at && out_of_view(verdict)) continue;
      look.share = std::min(look.share, verdict.share);
      if (!verdict.may_go_on() && look.obstacle.empty()) look.obstacle = verdict.text;
    }
    return look;
  };
}

}  // namespace prospect
