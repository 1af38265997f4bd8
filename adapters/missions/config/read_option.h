// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adapters/formats/files/strict_yaml.h"
#include "engine/problem/solver.h"

namespace prospect {

/// The value of the option, of the type of its default, which it has where it is absent. What is
/// wrong with it is a problem of the document.
OptionValue read_option(YamlMap map, const OptionInfo& option);

}  // namespace prospect
