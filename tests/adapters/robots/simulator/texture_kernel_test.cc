// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/texture_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace prospect::texture_kernel_test {
namespace {

TexturedView seen(const TexturePyramid& texture, const Eigen::Vector3f& inverse_depth,
                  const Eigen::Vector3f& s, const Eigen::Vector3f& t) {
  return {inverse_depth,
          s,
          t,
          0.9f,
          texture.texels(),
          static_cast<float>(texture.width()),
          static_cast<float>(texture.height())};
}

Image speckled(int width, int height) {
  std::mt19937 generator(3);
  Image image(width, height);
  for (std::uint8_t& grey : image.pixels) grey = static_cast<std::uint8_t>(generator() & 255u);
  return image;
}

/// From straight before it to edge-on, near and far, and planes through the camera.
std::vector<TexturedView> views(const TexturePyramid& texture) {
  std::vector<TexturedView> all;
  for (const float slope : {0.0f, 1e-3f, 0.05f, 3.0f}) {
    for (const float near : {4.0f, 0.3f, 1e-3f, 0.0f, -0.2f}) {
      all.push_back(
          seen(texture, {slope, 0.3f * slope, near}, {1e-3f, 2e-4f, 0.1f}, {-1e-4f, 2e-3f, 0.4f}));
    }
  }
  return all;
}

TEST(TextureKernel, SameBitsWithEveryInstructionSet) {
  for (const auto& [width, height] : {std::pair{61, 40}, {1, 1}, {300, 2}}) {
    const TexturePyramid texture(speckled(width, height));
    for (const TexturedView& view : views(texture)) {
      for (const float size : {0.5f, 1.0f, 6.0f}) {
        float u[kPacketPixels], v[kPacketPixels], first[kPacketPixels], grey[kPacketPixels];
        for (int n = 0; n < kPacketPixels; ++n) {
          u[n] = 37.0f * static_cast<float>(n % 4);
          v[n] = 29.0f * static_cast<float>(n / 4);
        }
        texture_kernel(InstructionSet::kGeneric)(view, u, v, size, first);
        for (const InstructionSet set : available_instruction_sets()) {
          texture_kernel(set)(view, u, v, size, grey);
          for (int n = 0; n < kPacketPixels; ++n) {
            ASSERT_EQ(grey[n], first[n]) << name(set) << ", pixel " << n;
            ASSERT_TRUE(grey[n] >= 0.0f && grey[n] <= 255.0f) << grey[n];
          }
        }
      }
    }
  }
}

TEST(TextureKernel, AMagnifiedTextureIsItsFinestLevel) {
  const TexturePyramid texture(speckled(64, 64));
  // A pixel is an eighth of a texel.
  const TexturedView view =
      seen(texture, {0.0f, 0.0f, 1.0f}, {1.0f / 512, 0.0f, 0.0f}, {0.0f, 1.0f / 512, 0.0f});
  float u[kPacketPixels], v[kPacketPixels], grey[kPacketPixels];
  for (int n = 0; n < kPacketPixels; ++n) {
    u[n] = 31.0f * static_cast<float>(n);
    v[n] = 17.0f * static_cast<float>(n);
  }
  texture_kernel(best_instruction_set())(view, u, v, 1.0f, grey);
  for (int n = 0; n < kPacketPixels; ++n) {
    EXPECT_FLOAT_EQ(grey[n], 0.9f * texture.bilinear(0, u[n] / 512, v[n] / 512)) << n;
  }
}

TEST(TextureKernel, AFootprintIsAveraged) {
  const TexturePyramid texture(speckled(64, 64));
  double mean = 0.0;
  for (const std::uint8_t grey : speckled(64, 64).pixels) mean += grey / 4096.0;
  // A pixel covers 64 x 64 texels, then 64 x 16: four taps of 16 x 16.
  for (const float across : {1.0f, 0.25f}) {
    const TexturedView view =
        seen(texture, {0.0f, 0.0f, 1.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, across, 0.1f});
    float u[kPacketPixels] = {}, v[kPacketPixels] = {}, grey[kPacketPixels];
    texture_kernel(best_instruction_set())(view, u, v, 1.0f, grey);
    EXPECT_NEAR(grey[0], 0.9 * mean, across == 1.0f ? 2.0 : 10.0);
  }
}

}  // namespace
}  // namespace prospect::texture_kernel_test
