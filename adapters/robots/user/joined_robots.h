// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "runtime/user_robot.h"

namespace prospect {

/// Throws std::invalid_argument, one line, for a robot or an option without a fit name, an option
/// that is there twice, and one whose make() is missing.
void check(const UserRobot& robot);

/// Throws std::invalid_argument, one line, for a robot that cannot map or is nowhere: none of its
/// streams measures ranges (one camera does not: depth images or scans beside it do), or nothing
/// says where it is.
void check_streams(const UserRobot& robot);

/// One robot of several parts, as of several plug-ins: streams, settings, options and sensors are
/// those of all; base, depth camera and emergency stop are of one of them each, the start of the
/// first that tells one. Its drivers are made in the order of the parts. Throws as check(), and if
/// two parts tell of the same; its make() likewise.
UserRobot joined(const std::vector<UserRobot>& parts);

}  // namespace prospect
