// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect {

/// Every key of a configuration file as a page of Markdown tables: key, unit, range, default and
/// what it is. Made of what reading a file asks for (ConfigEntry), so that it says what is read.
std::string configuration_reference();

}  // namespace prospect
