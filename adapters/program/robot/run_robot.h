// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "runtime/user_robot.h"

namespace prospect {

/// A whole program for a robot of one's own: main() returns it. It does what `prospect drive` does
/// for other robots, with its options (--help): reads a configuration, checks the robot before its
/// first motion, drives it by threads behind the guard, with a live view and faults on purpose if
/// asked for, and writes the run folder with the log, which `prospect report` and `prospect replay`
/// take. Returns the program's exit code: 0 done, 1 failed or not done, 2 bad input, 3 not built
/// in, 4 ended by a signal; what is wrong is a line on standard error. Throws nothing.
int run_robot(int argc, char** argv, const UserRobot& robot);

}  // namespace prospect
