// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/robots/simulator/feature_field.h"
#include "adapters/robots/simulator/simulator_options.h"

namespace prospect {

/// Where the odometry finds corners in a world that was read from a mesh: in its textures and at
/// its edges, by the odometry's own detector and stereo matcher, in pictures of it.
///
/// Pictures are taken from one place in each square of 2.5 m on which the robot has ample room,
/// the one nearest to the square's middle, all round: in as many directions as images of this width
/// cover the circle. A corner that detect_corners() finds and match_stereo() confirms lies where
/// its ray meets the world's voxels, on the face that it meets. It counts if another picture has
/// one within 0.1 m or two: where something near ends before something far, corners lie elsewhere
/// in each view, and are not tracked. Of those in a cube of 0.1 m the first one counts: the same
/// corner met along another ray lies up to a voxel's diagonal aside, and from 1.4 m the odometry
/// keeps but one of two that are nearer to each other (FeatureCamera).
/// What stands out only from nearer or farther than the pictures were taken is not told apart.
///
/// Empty for a world without a mesh. Deterministic. Throws NotBuiltIn without a renderer,
/// std::invalid_argument on options out of range. Source: our choice.
std::vector<Feature> features_in_views(const World& world, const SimulatorOptions& options);

/// The features that the kinematic tier tracks: those in views of a mesh, else, and where there is
/// no renderer, simulated_features().
FeatureField tracked_field(const World& world, const SimulatorOptions& options);

}  // namespace prospect
