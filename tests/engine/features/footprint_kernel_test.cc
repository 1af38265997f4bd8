// SPDX-License-Identifier: Apache-2.0
#include "engine/features/footprint_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "engine/features/footprint_visibility.h"
#include "tests/engine/view_worlds.h"

namespace prospect::footprint_kernel_test {
namespace {

using test::uniform;

struct Looked {
  std::vector<int> point;
  std::vector<double> q, d_x, d_y, d_z, d_yaw;
  bool operator==(const Looked&) const = default;
};

struct Inputs {
  FootprintKernelConstants constants;
  FootprintKernelPose pose;
  int n;
  std::vector<double> x, y, z, u, u_x, u_y, u_z;
};

Inputs random_inputs(std::mt19937_64& random, int n) {
  Inputs in;
  FootprintKernelConstants& c = in.constants;
  const double h = uniform(random, 0.2, 1.4), v = uniform(random, 0.2, 1.4);
  c.sin_h = std::sin(h);
  c.cos_h = std::cos(h);
  c.sin_v = std::sin(v);
  c.cos_v = std::cos(v);
  c.inset = uniform(random, 0.0, 3.0);
  const double angle = uniform(random, 0.01, 0.2), range = uniform(random, 0.02, 0.3);
  c.inverse_angle_scale = 1.0 / angle;
  c.inverse_range_scale = 1.0 / range;
  c.min_range = 0.3;
  c.max_range = uniform(random, 1.0, 5.0);
  c.negligible = std::exp(-12.0);
  c.outside_squared = std::pow((12.0 - c.inset) * angle, 2);
  c.far_squared = std::pow(c.max_range + (12.0 - c.inset) * range, 2);
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(in.pose.R) =
      Eigen::Quaterniond(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1),
                         uniform(random, 0.1, 1))
          .normalized()
          .toRotationMatrix();
  for (double& s : in.pose.sensor) s = uniform(random, -1, 1);
  for (double& a : in.pose.arm) a = uniform(random, -0.3, 0.3);
  in.n = n;
  const auto size = static_cast<std::size_t>(FootprintKernel::padded(n));
  for (auto* a : {&in.x, &in.y, &in.z, &in.u, &in.u_x, &in.u_y, &in.u_z}) a->assign(size, 0.0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    const double spread = i % 7 == 0 ? 0.05 : 5.0;
    in.x[i] = uniform(random, -spread, spread);
    in.y[i] = uniform(random, -spread, spread);
    in.z[i] = uniform(random, -spread, spread);
    in.u[i] = i % 3 == 0 ? 0.0 : uniform(random, 0, 1);
    in.u_x[i] = uniform(random, -3, 3);
    in.u_y[i] = uniform(random, -3, 3);
    in.u_z[i] = uniform(random, -3, 3);
  }
  return in;
}

Looked view(const FootprintKernel& kernel, const Inputs& in, bool gradient) {
  const auto size = static_cast<std::size_t>(FootprintKernel::padded(in.n));
  Looked l;
  l.point.resize(size);
  std::vector<double> X(size), Y(size), Z(size), u(size), u_x(size), u_y(size), u_z(size);
  const int n = kernel.select(in.constants, in.pose,
                              {in.x.data(), in.y.data(), in.z.data(), in.u.data(), in.n},
                              {l.point.data(), X.data(), Y.data(), Z.data()});
  for (std::size_t j = 0; j < static_cast<std::size_t>(FootprintKernel::padded(n)); ++j) {
    const auto c = static_cast<std::size_t>(l.point[j]);
    u[j] = in.u[c];
    u_x[j] = in.u_x[c];
    u_y[j] = in.u_y[c];
    u_z[j] = in.u_z[c];
  }
  for (auto* a : {&l.q, &l.d_x, &l.d_y, &l.d_z, &l.d_yaw}) a->resize(size);
  const FootprintKernel::Points selected{X.data(), Y.data(), Z.data(), u.data(), n};
  if (gradient) {
    kernel.gradient(in.constants, in.pose, selected, {u_x.data(), u_y.data(), u_z.data()},
                    {l.q.data(), l.d_x.data(), l.d_y.data(), l.d_z.data(), l.d_yaw.data()});
  } else {
    kernel.value(in.constants, selected, l.q.data());
  }
  l.point.resize(static_cast<std::size_t>(n));
  for (auto* a : {&l.q, &l.d_x, &l.d_y, &l.d_z, &l.d_yaw}) a->resize(static_cast<std::size_t>(n));
  return l;
}

TEST(FootprintKernel, SameBitsWithEveryInstructionSet) {
  std::mt19937_64 random(1);
  std::size_t looked = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Inputs in = random_inputs(random, trial % 67);
    for (const bool gradient : {false, true}) {
      const Looked expected = view(footprint_kernel(InstructionSet::kGeneric), in, gradient);
      for (const InstructionSet set : available_instruction_sets()) {
        ASSERT_EQ(view(footprint_kernel(set), in, gradient), expected) << name(set);
      }
      looked += expected.point.size();
    }
    ASSERT_EQ(view(footprint_kernel(best_instruction_set()), in, false).q,
              view(footprint_kernel(best_instruction_set()), in, true).q);
  }
  EXPECT_GT(looked, 1000u);
}

/// q of all points.
std::vector<float> score(const FootprintKernel& kernel, const Inputs& in) {
  const auto size = static_cast<std::size_t>(FootprintKernel::padded(in.n));
  const auto single = [](const std::vector<double>& x) {
    return std::vector<float>(x.begin(), x.end());
  };
  const std::vector<float> x = single(in.x), y = single(in.y), z = single(in.z), u = single(in.u);
  std::vector<float> X(size), Y(size), Z(size), open(size), looked(size);
  std::vector<int> point(size);
  const int n =
      kernel.select_score(in.constants, in.pose, {x.data(), y.data(), z.data(), u.data(), in.n},
                          {point.data(), X.data(), Y.data(), Z.data()});
  for (std::size_t j = 0; j < static_cast<std::size_t>(FootprintKernel::padded(n)); ++j) {
    open[j] = u[static_cast<std::size_t>(point[j])];
  }
  kernel.value_score(in.constants, {X.data(), Y.data(), Z.data(), open.data(), n}, looked.data());
  std::vector<float> q(static_cast<std::size_t>(in.n), 0.0f);
  for (std::size_t j = 0; j < static_cast<std::size_t>(n); ++j) {
    q[static_cast<std::size_t>(point[j])] = looked[j];
  }
  return q;
}

TEST(FootprintKernel, ScoresAreTheValueInSinglePrecision) {
  std::mt19937_64 random(5);
  double worst = 0.0, largest = 0.0;
  for (int trial = 0; trial < 400; ++trial) {
    const Inputs in = random_inputs(random, trial % 67);
    const Looked exact = view(footprint_kernel(InstructionSet::kGeneric), in, false);
    std::vector<double> q(static_cast<std::size_t>(in.n), 0.0);
    for (std::size_t j = 0; j < exact.point.size(); ++j) {
      q[static_cast<std::size_t>(exact.point[j])] = exact.q[j];
    }
    const std::vector<float> expected = score(footprint_kernel(InstructionSet::kGeneric), in);
    for (std::size_t i = 0; i < q.size(); ++i) {
      worst = std::max(worst, std::abs(static_cast<double>(expected[i]) - q[i]));
      largest = std::max(largest, q[i]);
    }
    for (const InstructionSet set : available_instruction_sets()) {
      ASSERT_EQ(score(footprint_kernel(set), in), expected) << name(set);
    }
  }
  EXPECT_GT(largest, 0.5);
  EXPECT_LT(worst, 6e-6);
}

TEST(FootprintKernel, WhatIsNotSelectedIsExactlyZeroAndTheRestFollowsTheFormula) {
  std::mt19937_64 random(2);
  const auto sigmoid = [](double a) { return 1.0 / (1.0 + std::exp(-a)); };
  int selected = 0, left_out = 0, cut_off = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Inputs in = random_inputs(random, 50);
    const FootprintKernelConstants& c = in.constants;
    const Looked l = view(footprint_kernel(best_instruction_set()), in, false);
    std::size_t next = 0;
    for (int i = 0; i < in.n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Eigen::Vector3d p =
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(in.pose.R) *
          (Eigen::Vector3d(in.x[at], in.y[at], in.z[at]) - Eigen::Vector3d::Map(in.pose.sensor));
      const double rho = std::sqrt(p.x() * p.x() + p.z() * p.z() + 4e-4);
      const double r = std::sqrt(p.squaredNorm() + 4e-4);
      double g = sigmoid((r - c.min_range) * c.inverse_range_scale - c.inset) *
                 sigmoid((c.max_range - r) * c.inverse_range_scale - c.inset);
      for (const double sign : {-1.0, 1.0}) {
        g *= sigmoid((c.sin_h * p.z() + sign * c.cos_h * p.x()) / rho * c.inverse_angle_scale -
                     c.inset);
        g *=
            sigmoid((c.sin_v * rho + sign * c.cos_v * p.y()) / r * c.inverse_angle_scale - c.inset);
      }
      const double e = c.negligible;
      const double expected = g > e ? in.u[at] * (g - e) * (g - e) / g : 0.0;
      EXPECT_LE(std::abs(expected - in.u[at] * g), 2.0 * e);
      if (next < l.point.size() && l.point[next] == i) {
        ASSERT_NEAR(l.q[next], expected, 1e-12);
        ASSERT_GE(l.q[next], 0.0);
        ++next;
        ++selected;
        cut_off += expected == 0.0;
      } else {
        ASSERT_EQ(expected, 0.0) << "left out in spite of g = " << g;
        ++left_out;
      }
    }
    ASSERT_EQ(next, l.point.size());
  }
  EXPECT_GT(selected, 1000);
  EXPECT_GT(left_out, selected);
  EXPECT_LT(cut_off, selected);
}

TEST(FootprintKernel, DerivativeIsContinuousAcrossTheCutOff) {
  // A target that leaves the view: q and its slope reach 0 together.
  const VoxelGrid empty(GridFrame{0.1, -60, -60, 120, 120}, 0.0, 1.0);
  OcclusionTable::Options see_through;
  see_through.attenuation = 0.0;
  const auto table = std::make_shared<const OcclusionTable>(
      SensorLattice::around({0, 0, 0.45}, 1.0, 0.2), std::vector<Eigen::Vector3d>{{2.0, 0.0, 0.45}},
      empty, see_through);
  const FootprintVisibility view(RgbdFootprint(), CameraMount(), table);
  FootprintVisibility::Scratch scratch(1);
  const double weight = 1.0;
  Pose pose;
  double last_q = 1.0, last_slope = 0.0;
  bool vanished = false;
  for (pose.yaw = 0.0; pose.yaw < M_PI; pose.yaw += 1e-4) {
    double q;
    view.evaluate(pose, scratch, &q);
    const double slope = view.gradient(pose, &weight, scratch)[3];
    if (pose.yaw > 0.0) {
      ASSERT_NEAR(q, last_q, 1e-3);
      ASSERT_NEAR(q - last_q, 0.5e-4 * (slope + last_slope), 1e-9);
      ASSERT_NEAR(slope, last_slope, 0.02);
      if (q == 0.0 && last_q > 0.0) {
        EXPECT_LT(last_q, 1e-9);
        EXPECT_LT(std::abs(last_slope), 1e-6);
        vanished = true;
      }
    }
    last_q = q;
    last_slope = slope;
  }
  EXPECT_TRUE(vanished);
}

}  // namespace
}  // namespace prospect::footprint_kernel_test
