// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

/// An estimate of the path from where a robot is back to where it began.
struct ReturnPath {
  double length = 0.0;  ///< [m of path equivalent] (traversability.h), at least the straight line
  double time = 0.0;    ///< [s] that it takes, as robots drive it
};

}  // namespace prospect
