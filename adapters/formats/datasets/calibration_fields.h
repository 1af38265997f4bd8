// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "adapters/formats/files/field_rule.h"

namespace prospect {

/// The forms of read_stereo_calibration().
enum class CalibrationForm { kKitti, kKittiRaw, kCameraInfo, kOpenCv, kKalibr, kZed };

/// Every key of a form of calibration files, once: those that the programs write whose form it is.
/// Of keys that differ by a number at their end (K_00, K_01; CV_2K, CV_HD) the part before it. A
/// test holds the tables against files with all keys, and against what reading makes of each.
std::span<const FieldRule> fields_of(CalibrationForm form);

}  // namespace prospect
