// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace prospect {

/// What measures: the program (build_info.h), the processor, its cores that this process may use,
/// memory [MB], operating system and kernel, when it was asked (UTC), the load of the machine
/// (means of 1, 5 and 15 minutes) and the variables of the environment that set threads of linear
/// algebra. Holds nothing that names a machine or a person. What the system does not tell is null.
nlohmann::ordered_json environment();

}  // namespace prospect
