// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "models/camera.h"
#include "perception/mapping/depth_image.h"
#include "runtime/preflight.h"

namespace prospect {

/// The floor as one depth image of a camera on the body shows it (find_ground() of
/// perception/mapping), against how the camera is mounted, for pre-flight. base_height: of B's
/// origin above the floor [m]. None: no floor was found within 0.2 m and 0.2 rad of the mount.
/// Pure; never throws, whatever the image holds.
std::optional<PreflightFacts::Floor> seen_floor(const DepthImage& image,
                                                const PinholeCamera& camera,
                                                const CameraMount& mount, double base_height,
                                                const DepthRange& range);

}  // namespace prospect
