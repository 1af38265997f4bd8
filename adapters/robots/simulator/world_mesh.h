// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adapters/formats/worlds/textured_mesh.h"
#include "adapters/formats/worlds/world.h"
#include "adapters/robots/simulator/feature_field.h"

namespace prospect {

struct WorldMeshOptions {
  /// Contrast of the marks: 1 rich, 0 blank.
  double texture_quality = 1.0;
  double texel = 0.005;  ///< [m] of the textures of rectangles that bear marks
  std::uint64_t seed = 1;
};

/// What a camera sees of a world of voxels: the faces between free voxels and all others, the
/// outside of the grid among them; neighbouring faces of a plane are merged into rectangles, row by
/// row as wide and then as high as they go.
///
/// Rectangles reach 20 um beyond their faces, so that no ray slips through where the corner of one
/// lies on another's edge.
///
/// Texture: each feature of the field is a mark on its surface, painted at its place: a convex
/// polygon of three to six sides and 3 to 8 cm, most with a second one of the opposite contrast
/// inside, all drawn from a hash of the seed and the feature's index. Marks end where their
/// surface ends. Below them lies a
/// variation of +-8 grey levels over half a metre and more, too smooth to give a corner, on a grey
/// that tells floor from furniture, walls and ceiling. With quality 0 that is all there is.
///
/// Deterministic in (world, features, options). Errors: std::invalid_argument on options out of
/// range or a world without free voxels.
TexturedMesh world_mesh(const World& world, const FeatureField& features,
                        const WorldMeshOptions& options = {});

}  // namespace prospect
