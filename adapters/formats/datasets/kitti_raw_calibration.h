// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/formats/datasets/stereo_calibration.h"

namespace prospect {

/// Whether a file is KITTI's calibration of raw drives, calib_cam_to_cam.txt, or KITTI-360's
/// perspective.txt, which has its form: it states P_rect_00.
bool is_kitti_raw_calibration(const std::string& path);

/// Of the cameras `first` and the next: of rectified images, by P_rect and S_rect, or of the
/// cameras' own, by K, D, R, T and S, whichever has the images' size. Throws InputError, one line.
StereoCalibration read_kitti_raw_calibration(const std::string& path, int first);

}  // namespace prospect
