// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/simulator_options.h"

namespace prospect {

/// The depth sensors of a simulated robot as rays, by their number, each with noise of its own.
/// `world` outlives them. Throws std::invalid_argument on options out of range.
std::vector<DepthCamera> depth_cameras(const World& world, const SimulatorOptions& options);

}  // namespace prospect
