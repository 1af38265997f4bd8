// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

/// How unknown space limits motion.
enum class UnknownPolicy {
  kFree,     ///< not at all: unknown space is treated as free
  kBlocked,  ///< like an obstacle: clearance to it of at least d_safe
  kBraking   ///< the robot must at all times be able to stop inside known free space
};

}  // namespace prospect
