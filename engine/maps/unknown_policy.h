// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

/// How unknown space limits motion.
enum class UnknownPolicy {
  kFree,     ///< not at all: unknown space is treated as free
  kBlocked,  ///< like an obstacle: clearance to it of at least d_safe
  kBraking   ///< the robot must at all times be able to stop inside known free space
};

/// What a planner makes of ground whose floor no ray has met.
enum class UnseenFloor {
  kAssumed,  ///< it is there: of robots whose sensors do not look at it, on floors without edges
  kBlocked   ///< it is not driven onto
};

}  // namespace prospect
