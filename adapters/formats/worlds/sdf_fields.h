// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "adapters/formats/files/field_rule.h"

namespace prospect {

/// Every element and attribute that SDF (1.4 to 1.12) has on the way to a world's surfaces, once
/// and sorted: "visual/geometry", "pose@degrees". Nothing below an element that is not needed or
/// refused. Models and links of a <state> are model_state and link_state, as SDF 1.12 calls them.
///
/// What is refused is left out and told (LeftOut), as is what is not in the table, or ends the
/// reading. Source: the specification's own description, sdformat's `sdf/1.*/*.sdf`. Tests hold the
/// table against it, and against what reading makes of each.
std::span<const FieldRule> sdf_fields();

/// The row of a name; null: there is none.
const FieldRule* sdf_field(std::string_view name);

}  // namespace prospect
