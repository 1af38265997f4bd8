// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "adapters/formats/files/field_rule.h"

namespace prospect {

/// Every key of a ROS map's .yaml that map_server knows, once. Other keys are named as left out. A
/// test holds the table against the keys that are read, and against what reading makes of each.
std::span<const FieldRule> ros_map_fields();

}  // namespace prospect
