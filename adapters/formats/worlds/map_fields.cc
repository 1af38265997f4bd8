// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/map_fields.h"

namespace prospect {
namespace {

using enum FieldUse;

constexpr FieldRule kRosMapFields[] = {
    {"image", kUsed},           {"resolution", kUsed},  {"origin", kUsed}, {"negate", kUsed},
    {"occupied_thresh", kUsed}, {"free_thresh", kUsed}, {"mode", kUsed},
};

}  // namespace

std::span<const FieldRule> ros_map_fields() { return kRosMapFields; }

}  // namespace prospect
