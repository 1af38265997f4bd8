// SPDX-License-Identifier: Apache-2.0
#include "engine/features/occlusion_kernel.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace prospect::occlusion_kernel_test {
namespace {

struct Output {
  std::vector<double> value, d_x, d_y, d_z;
  bool operator==(const Output&) const = default;
};

struct Plane {
  OcclusionPlane plane;
  std::vector<float> values;
  int n;

  Plane(std::mt19937_64& random, int points) : n(points) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < 9 * points; ++i) {
      values.push_back(i % 5 == 0 ? 0.0f : static_cast<float>(unit(random)));
    }
    for (int r = 0; r < 9; ++r) plane.rows[r] = values.data() + r * points;
    for (int a = 0; a < 3; ++a) {
      plane.x[a] = unit(random);
      plane.y[a] = unit(random);
      plane.dx[a] = 10.0 * unit(random) - 5.0;
      plane.dy[a] = 10.0 * unit(random) - 5.0;
    }
    plane.z = unit(random);
    plane.dz = 10.0 * unit(random) - 5.0;
  }

  Output run(InstructionSet set, int derivatives, bool first) const {
    const std::vector<double> before(static_cast<std::size_t>(n), first ? 7.0 : 0.25);
    Output o{before, before, before, before};
    occlusion_kernel(set)(plane, n, first, o.value.data(), derivatives > 0 ? o.d_x.data() : nullptr,
                          derivatives > 0 ? o.d_y.data() : nullptr,
                          derivatives > 2 ? o.d_z.data() : nullptr);
    return o;
  }
};

TEST(OcclusionKernel, SameBitsWithEveryInstructionSetAndWithDerivatives) {
  std::mt19937_64 random(1);
  for (int n = 0; n < 70; ++n) {
    const Plane p(random, n);
    for (const bool first : {false, true}) {
      const Output full = p.run(InstructionSet::kGeneric, 3, first);
      for (const int derivatives : {0, 2, 3}) {
        const Output expected = p.run(InstructionSet::kGeneric, derivatives, first);
        EXPECT_EQ(expected.value, full.value);
        for (const InstructionSet set : available_instruction_sets()) {
          ASSERT_EQ(p.run(set, derivatives, first), expected) << name(set) << ", " << n;
        }
      }
    }
  }
}

TEST(OcclusionKernel, IsTheWeightedSumOfRows) {
  std::mt19937_64 random(2);
  const Plane p(random, 21);
  const Output o = p.run(best_instruction_set(), 3, false);
  for (int i = 0; i < p.n; ++i) {
    double value = 0.25, d_x = 0.25, d_y = 0.25, d_z = 0.25;
    for (int b = 0; b < 3; ++b) {
      for (int a = 0; a < 3; ++a) {
        const double v = p.plane.rows[3 * b + a][i];
        value += v * p.plane.x[a] * p.plane.y[b] * p.plane.z;
        d_x += v * p.plane.dx[a] * p.plane.y[b] * p.plane.z;
        d_y += v * p.plane.x[a] * p.plane.dy[b] * p.plane.z;
        d_z += v * p.plane.x[a] * p.plane.y[b] * p.plane.dz;
      }
    }
    const auto n = static_cast<std::size_t>(i);
    EXPECT_NEAR(o.value[n], value, 1e-13);
    EXPECT_NEAR(o.d_x[n], d_x, 1e-13);
    EXPECT_NEAR(o.d_y[n], d_y, 1e-13);
    EXPECT_NEAR(o.d_z[n], d_z, 1e-13);
  }
}

TEST(OcclusionKernel, ScoresAreTheValueInSinglePrecision) {
  std::mt19937_64 random(3);
  for (int n = 1; n < 70; ++n) {
    const Plane p(random, n);
    for (const bool first : {false, true}) {
      const Output exact = p.run(InstructionSet::kGeneric, 0, first);
      const std::vector<float> before(static_cast<std::size_t>(n), first ? 7.0f : 0.25f);
      std::vector<float> expected = before;
      occlusion_score_kernel(InstructionSet::kGeneric)(p.plane, n, first, expected.data());
      for (std::size_t i = 0; i < expected.size(); ++i) {
        // The weights of this plane are not those of a spline: they sum up to more than 1.
        ASSERT_NEAR(static_cast<double>(expected[i]), exact.value[i], 9e-6);
      }
      for (const InstructionSet set : available_instruction_sets()) {
        std::vector<float> score = before;
        occlusion_score_kernel(set)(p.plane, n, first, score.data());
        ASSERT_EQ(score, expected) << name(set) << ", " << n;
      }
    }
  }
}

}  // namespace
}  // namespace prospect::occlusion_kernel_test
