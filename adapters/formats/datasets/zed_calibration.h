// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/formats/datasets/stereo_calibration.h"

namespace prospect {

/// Stereolabs' calibration of a ZED, SN12345.conf, of the camera's raw images, for each of its
/// resolutions that the file states (2K, FHD, HD, VGA, FHD1200, SVGA): sections LEFT_CAM_RES and
/// RIGHT_CAM_RES with fx fy cx cy k1 k2 p1 p2 k3, and STEREO with Baseline, TY, TZ [mm] and the
/// rotation vector RX, CV, RZ [rad], of each resolution if RES follows the name. As Stereolabs' own
/// programs take it, x_right = R x_left - (Baseline, TY, TZ). Throws InputError, one line.
StereoCalibration read_zed_calibration(const std::string& path);

}  // namespace prospect
