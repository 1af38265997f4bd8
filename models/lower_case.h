// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect {

/// `text` with the letters A to Z as a to z; other bytes, such as those of UTF-8, as they are.
std::string lower_case(std::string text);

}  // namespace prospect
