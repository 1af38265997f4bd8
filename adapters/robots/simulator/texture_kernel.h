// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "adapters/robots/simulator/texture_pyramid.h"
#include "engine/support/instruction_set.h"

namespace prospect {

inline constexpr int kPacketPixels = 16;  ///< that are looked up abreast

/// A textured plane as functions of the pixel x = (u, v, 1), all linear: with
/// w = 1/z = inverse_depth . x, the texture coordinates are (s . x) / w and (t . x) / w.
struct TexturedView {
  Eigen::Vector3f inverse_depth, s, t;
  float shade = 0.0f;
  TexturePyramid::Texels texels{};
  float width = 0.0f, height = 0.0f;  ///< of the texture
};

/// Greys of a packet's pixels (u, v), as if all showed this plane: each the mean over the square of
/// `size` pixels about it, trilinear, by up to four taps along the longer axis of its footprint. A
/// plane seen edge-on, where rounding has the last word, has its mean grey.
using TextureKernel = void (*)(const TexturedView& view, const float* u, const float* v, float size,
                               float* grey);

/// The same bits with every instruction set.
TextureKernel texture_kernel(InstructionSet set);

/// TexturePyramid::mean_along().
float mean_along(const TexturePyramid::Texels& texels, float level, float u, float v, float du,
                 float dv, int taps);

}  // namespace prospect
