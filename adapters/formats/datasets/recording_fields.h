// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "adapters/formats/files/field_rule.h"

namespace prospect {

/// Files of recordings in which keys or columns say what a number is.
enum class RecordingFile {
  kEurocSensor,    ///< sensor.yaml of a camera: keys, those of T_BS behind a dot
  kEurocTruth,     ///< data.csv of a ground truth: columns
  kTumTrajectory,  ///< columns
};

/// Every key or column of such a file, once. Other keys are named as passed over. A test holds the
/// tables against the keys that are read, and against what reading makes of each.
std::span<const FieldRule> fields_of(RecordingFile file);

}  // namespace prospect
