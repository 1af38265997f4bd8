// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/formats/ros/message_definition.h"

namespace prospect {

/// The hash by which ROS 2 (since Iron) tells types of one name apart, REP 2016:
/// "RIHS01_<64 hexadecimal digits>". Throws NotBuiltIn without OpenSSL.
std::string type_hash(const std::vector<ros::MessageDefinition>& definition);

}  // namespace prospect
