// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/calibration_fields.h"

namespace prospect {
namespace {

using enum FieldUse;

constexpr FieldRule kKittiFields[] = {
    {"P", kUsed},
    {"Tr", kNotNeeded, "where the lidar is"},
};

constexpr FieldRule kKittiRawFields[] = {
    {"calib_time", kNotNeeded, "when it was made"},
    {"corner_dist", kNotNeeded, "of the board that it was made with"},
    {"S", kUsed},
    {"K", kUsed},
    {"D", kUsed},
    {"R", kUsed},
    {"T", kUsed},
    {"S_rect", kUsed},
    {"R_rect", kNotNeeded, "the cameras' own images are rectified anew"},
    {"P_rect", kUsed},
};

constexpr FieldRule kCameraInfoFields[] = {
    {"image_width", kUsed},
    {"image_height", kUsed},
    {"camera_name", kNotNeeded, "a name"},
    {"rows", kNotNeeded, "the matrix says how many"},
    {"cols", kNotNeeded, "the matrix says how many"},
    {"data", kUsed},
    {"distortion_model", kUsed},
    {"binning_x", kUsed},
    {"binning_y", kUsed},
    {"x_offset", kUsed},
    {"y_offset", kUsed},
    {"height", kUsed},
    {"width", kUsed},
    {"do_rectify", kNotNeeded, "K and P of the window are the same either way"},
};

constexpr FieldRule kOpenCvFields[] = {
    {"calibration_time", kNotNeeded, "when it was made"},
    {"board_width", kNotNeeded, "of the board that it was made with"},
    {"board_height", kNotNeeded, "of the board that it was made with"},
    {"square_size", kNotNeeded, "of the board that it was made with"},
    {"flags", kNotNeeded, "how it was made"},
    {"avg_reprojection_error", kNotNeeded, "how well it fits"},
    {"image_width", kUsed},
    {"image_height", kUsed},
    {"distortion_model", kUsed},
    {"M", kUsed},
    {"D", kUsed},
    {"R", kUsed},
    {"T", kUsed},
    {"E", kNotNeeded, "follows from R and T"},
    {"F", kNotNeeded, "follows from M, R and T"},
    {"R1", kNotNeeded, "the images are rectified anew"},
    {"R2", kNotNeeded, "the images are rectified anew"},
    {"P", kNotNeeded, "the images are rectified anew"},
    {"Q", kNotNeeded, "the images are rectified anew"},
};

constexpr FieldRule kKalibrFields[] = {
    {"cam_overlaps", kNotNeeded, "how it was made"},
    {"camera_model", kChecked},
    {"distortion_coeffs", kUsed},
    {"distortion_model", kUsed},
    {"intrinsics", kUsed},
    {"resolution", kUsed},
    {"rostopic", kNotNeeded, "a name"},
    {"timeshift_cam_imu", kNotNeeded, "stamps of an IMU are taken as they are"},
    {"T_cam_imu", kNotNeeded, "T_cn_cnm1 says where the cameras are"},
    {"T_cn_cnm", kUsed},
};

constexpr FieldRule kZedFields[] = {
    {"fx", kUsed},
    {"fy", kUsed},
    {"cx", kUsed},
    {"cy", kUsed},
    {"k", kUsed},
    {"p", kUsed},
    {"Baseline", kUsed},
    {"TY", kUsed},
    {"TZ", kUsed},
    {"CV", kUsed},
    {"RX", kUsed},
    {"RZ", kUsed},
    {"Sensor_ID", kNotNeeded, "a name"},
};

}  // namespace

std::span<const FieldRule> fields_of(CalibrationForm form) {
  switch (form) {
    case CalibrationForm::kKitti:
      return kKittiFields;
    case CalibrationForm::kKittiRaw:
      return kKittiRawFields;
    case CalibrationForm::kCameraInfo:
      return kCameraInfoFields;
    case CalibrationForm::kOpenCv:
      return kOpenCvFields;
    case CalibrationForm::kKalibr:
      return kKalibrFields;
    case CalibrationForm::kZed:
      return kZedFields;
  }
  return {};
}

}  // namespace prospect
