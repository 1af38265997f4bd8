// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/formats/datasets/stereo_calibration.h"

namespace prospect {

/// The part of a sensor that its images show, and how coarsely, as a camera_info of ROS states it.
struct CameraWindow {
  double binning_x = 0.0, binning_y = 0.0;  ///< pixels of the sensor an image's pixel; 0 means 1
  double x_offset = 0.0, y_offset = 0.0;    ///< roi, in pixels of the sensor
  double width = 0.0, height = 0.0;         ///< roi; all four 0: the whole sensor
};

/// The calibration of the images, from that of the whole sensor, as image_geometry has it: K and P
/// are shifted by the window's offset and divided by the binning, so a pixel u of the sensor is
/// (u - x_offset) / binning_x of an image; its size is that of the window by the binning. D and R
/// hold for both. Throws InputError, which names roi or binning, for a window without a size or a
/// binning below one pixel. `where` stands for the message or file.
CameraInfo of_images(CameraInfo sensor, const CameraWindow& window, const std::string& where);

}  // namespace prospect
