// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>

#include "models/camera.h"
#include "models/types.h"
#include "perception/mapping/depth_image.h"
#include "runtime/range_stop.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// What raw ranges say of a command, apart from all maps.
struct RangeCheck {
  double share = 1.0;    ///< of the command that may be driven, 0 to 1
  std::string obstacle;  ///< why it may not be driven at all; empty: it may
};

/// A depth camera as the independent look knows it.
struct RangeCamera {
  PinholeCamera camera;
  CameraMount mount;
  DepthRange range;
  int stride = 4;  ///< every so manyeth pixel of a row and of a column, >= 1
};

/// Rays of a depth image. A depth beyond the range is a ray that is clear up to the range's end;
/// one before it, or none, says nothing. An image that is not of the camera's size has no rays.
RangeFrame range_frame(const DepthFrame& depth, const RangeCamera& camera);
/// Hits and misses of a scan.
RangeFrame range_frame(const ScanFrame& scan);

/// Depth cameras by the number of their sensor.
using RangeCameras = std::map<int, RangeCamera>;

/// Asks `stop` of the newest depth image and scan of each depth sensor in the inbox, if there has
/// been any, and takes the smallest share. What one sensor does not have in view at all another
/// may: then that one decides. One look that shows nothing where the body drives decides nothing:
/// the one before it is asked, as old as it is. All outlive what is returned. Thread-safety: as
/// RangeStop and SensorInbox, so any thread.
std::function<RangeCheck(const Twist& command, double now)> range_check(
    const SensorInbox& inbox, const RangeStop& stop, const RangeCameras& cameras);

}  // namespace prospect
