// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace prospect {

/// Throws std::invalid_argument "OWNER: NAME is VALUE; expected EXPECTED" unless `ok`.
/// Conditions written as `value > 0` are false for NaN, so NaN is always refused.
void check_parameter(bool ok, std::string_view owner, std::string_view name, double value,
                     std::string_view expected);

/// The same for a value that must be finite and > 0, finite and >= 0, or just finite.
void check_positive(std::string_view owner, std::string_view name, double value);
void check_not_negative(std::string_view owner, std::string_view name, double value);
void check_finite(std::string_view owner, std::string_view name, double value);

}  // namespace prospect
