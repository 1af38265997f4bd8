// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace prospect {

inline constexpr double kDegrees = 180.0 / std::numbers::pi;  ///< of a radian

}  // namespace prospect
