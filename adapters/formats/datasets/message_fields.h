// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "adapters/formats/files/field_rule.h"

namespace prospect {

/// Every field of a message of ROS 2 that is read from bags or over DDS, once, by its type:
/// "sensor_msgs/msg/Image"; empty of others. Tests hold the tables against the messages'
/// definitions, and against what reading makes of each field. A message that is refused is left out
/// and counted in a bag, and a fault of its topic over DDS.
std::span<const FieldRule> fields_of(const char* type);

}  // namespace prospect
