// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/recording_fields.h"

namespace prospect {
namespace {

using enum FieldUse;

constexpr FieldRule kEurocSensorFields[] = {
    {"sensor_type", kChecked},
    {"comment", kNotNeeded, "free text"},
    {"camera_id", kNotNeeded, "a name"},
    {"rate_hz", kUsed},
    {"camera_model", kChecked},
    {"distortion_model", kUsed},
    {"resolution", kUsed},
    {"intrinsics", kUsed},
    {"distortion_coefficients", kUsed},
    {"T_BS.cols", kChecked},
    {"T_BS.rows", kChecked},
    {"T_BS.data", kUsed},
};

constexpr FieldRule kEurocTruthFields[] = {
    {"timestamp", kUsed},
    {"p_RS_R_x", kUsed},
    {"p_RS_R_y", kUsed},
    {"p_RS_R_z", kUsed},
    {"q_RS_w", kUsed},
    {"q_RS_x", kUsed},
    {"q_RS_y", kUsed},
    {"q_RS_z", kUsed},
    {"v_RS_R_x", kNotNeeded, "a velocity: where the body is says the pose"},
    {"v_RS_R_y", kNotNeeded, "likewise"},
    {"v_RS_R_z", kNotNeeded, "likewise"},
    {"b_w_RS_S_x", kNotNeeded, "no inertial sensor is read"},
    {"b_w_RS_S_y", kNotNeeded, "no inertial sensor is read"},
    {"b_w_RS_S_z", kNotNeeded, "no inertial sensor is read"},
    {"b_a_RS_S_x", kNotNeeded, "no inertial sensor is read"},
    {"b_a_RS_S_y", kNotNeeded, "no inertial sensor is read"},
    {"b_a_RS_S_z", kNotNeeded, "no inertial sensor is read"},
};

constexpr FieldRule kTumTrajectoryFields[] = {
    {"timestamp", kUsed}, {"tx", kUsed}, {"ty", kUsed}, {"tz", kUsed},
    {"qx", kUsed},        {"qy", kUsed}, {"qz", kUsed}, {"qw", kUsed},
};

}  // namespace

std::span<const FieldRule> fields_of(RecordingFile file) {
  switch (file) {
    case RecordingFile::kEurocSensor:
      return kEurocSensorFields;
    case RecordingFile::kEurocTruth:
      return kEurocTruthFields;
    case RecordingFile::kTumTrajectory:
      return kTumTrajectoryFields;
  }
  return {};
}

}  // namespace prospect
