// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "adapters/formats/worlds/left_out.h"
#include "models/image.h"

namespace prospect {

/// Triangles with grey textures, in frame W [m]: z up, floor z = 0. A value.
///
/// Both sides of a triangle are seen. Texture coordinates (u right, v down) span an image over
/// [0, 1] x [0, 1], (0, 0) its upper left corner (not the centre of its first pixel); outside it
/// repeats. Within a triangle they are affine. A pixel is an albedo, 255 white.
struct TexturedMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector2f> uv;  ///< of each vertex
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> material;  ///< of each triangle: its texture
  std::vector<Image> textures;          ///< 1 x 1 for a plain grey
  LeftOut left_out = {};                ///< what the source holds besides
};

}  // namespace prospect
