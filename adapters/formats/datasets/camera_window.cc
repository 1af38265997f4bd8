// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/camera_window.h"

#include <cmath>

#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/files/input_error.h"

namespace prospect {

CameraInfo of_images(CameraInfo sensor, const CameraWindow& window, const std::string& where) {
  const auto binning = [&](double pixels) {
    if (pixels == 0.0) return 1.0;
    if (!(pixels >= 1.0)) {
      throw InputError(where + ": binning by " + number_text(pixels) +
                       "; expected 1 pixel of the sensor or more (0: none)");
    }
    return pixels;
  };
  const double bx = binning(window.binning_x), by = binning(window.binning_y);
  double width = window.width, height = window.height;
  if (width == 0.0 && height == 0.0 && window.x_offset == 0.0 && window.y_offset == 0.0) {
    width = sensor.width;
    height = sensor.height;
  } else if (!(width >= 1.0 && height >= 1.0 && window.x_offset >= 0.0 && window.y_offset >= 0.0)) {
    throw InputError(where + ": roi of " + number_text(width) + " x " + number_text(height) +
                     " pixels at (" + number_text(window.x_offset) + ", " +
                     number_text(window.y_offset) +
                     "); expected a size and where it is in the sensor, or all 0");
  }
  if (sensor.K.size() == 9) {
    sensor.K[2] = (sensor.K[2] - window.x_offset) / bx;
    sensor.K[5] = (sensor.K[5] - window.y_offset) / by;
    sensor.K[0] /= bx;
    sensor.K[1] /= bx;
    sensor.K[4] /= by;
  }
  if (sensor.P.size() == 12) {
    // The fourth column, f times a baseline, is in pixels, but of no place in the image.
    sensor.P[2] = (sensor.P[2] - window.x_offset) / bx;
    sensor.P[6] = (sensor.P[6] - window.y_offset) / by;
    for (const int n : {0, 1, 3}) sensor.P[static_cast<std::size_t>(n)] /= bx;
    for (const int n : {5, 7}) sensor.P[static_cast<std::size_t>(n)] /= by;
  }
  sensor.width = std::floor(width / bx);
  sensor.height = std::floor(height / by);
  return sensor;
}

}  // namespace prospect
