// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace prospect {

/// Told every now and then what is going on while a world is read, in a few words, for a progress
/// line; may be empty.
using LoadProgress = std::function<void(const std::string&)>;

}  // namespace prospect
