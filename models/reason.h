// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect {

/// Appends to what a state is explained by; several reasons are joined by "; ".
inline void add_reason(std::string& reasons, const std::string& reason) {
  reasons += (reasons.empty() ? "" : "; ") + reason;
}

}  // namespace prospect
