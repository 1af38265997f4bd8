// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/program/cli/command_description.h"

namespace prospect {

/// Manual page of the program, man(7), section 1: "prospect.1".
std::string manual_page(const CommandDescription& program);
/// Of one of its commands: "prospect-explore.1".
std::string manual_page(const CommandDescription& program, const CommandDescription& command);

}  // namespace prospect
