// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/patch_slope.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "perception/odometry/patch_samples.h"

namespace prospect {
namespace {

constexpr int kR = kPatchRadius;
constexpr int kSide = 2 * kR + 1;
constexpr int kUnknowns = 6;  // delta, e, alpha, beta
constexpr int kIterations = 20;
constexpr float kTolerance = 0.01f;  // [px]
constexpr float kPriorSlope = 0.3f;  // [px/px]
constexpr float kAlike = 10.0f;      // neighbouring pixels that err alike

using Samples = Eigen::Matrix<float, kSide * kSide, 1>;
using Columns = Eigen::Matrix<float, kSide * kSide, kUnknowns>;
using Matrix6f = Eigen::Matrix<float, kUnknowns, kUnknowns>;
using Vector6f = Eigen::Matrix<float, kUnknowns, 1>;

/// Whether all c + (x, y), |x| and |y| up to these, may be sampled. NaN may not.
bool inside(const PyramidLevel& level, const Eigen::Vector2f& c, float reach_x, float reach_y) {
  return c.x() - reach_x >= 0 && c.x() + reach_x < level.width - 1 && c.y() - reach_y >= 0 &&
         c.y() + reach_y < level.height - 1;
}

/// The samples at c + A x, row by row.
Samples sample(const PyramidLevel& level, const Eigen::Vector2f& c, const Eigen::Matrix2f& A) {
  return sample_square<kR>(level, c, A).head<kSide * kSide>();
}

}  // namespace

std::optional<SlantedPatch> align_slanted(const PyramidLevel& left, const Eigen::Vector2f& centre,
                                          const PyramidLevel& right, const Eigen::Vector2f& start,
                                          float residual, float max_shift) {
  // One sample more on every side, for the gradients.
  if (!inside(left, centre, kR + 1, kR + 1)) return {};
  Samples w;
  Columns J;
  const Eigen::Matrix2f I = Eigen::Matrix2f::Identity();
  const auto gradient = [&](const Eigen::Vector2f& step) {
    return Samples(0.5f * (sample(left, centre + step, I) - sample(left, centre - step, I)));
  };
  const Samples T = sample(left, centre, I);
  J.col(0) = gradient(Eigen::Vector2f::UnitX());
  J.col(1) = gradient(Eigen::Vector2f::UnitY());
  int k = 0;
  for (int y = -kR; y <= kR; ++y) {
    for (int x = -kR; x <= kR; ++x, ++k) {
      w[k] = patch_weight(x, y);
      J(k, 2) = x * J(k, 0);
      J(k, 3) = y * J(k, 0);
    }
  }
  w /= w.sum();
  J.col(4) = T.array() - w.dot(T);
  J.col(5).setOnes();
  const Columns wJ = w.asDiagonal() * J;
  const float prior = residual * w.squaredNorm() * kAlike / (kPriorSlope * kPriorSlope);
  Matrix6f H = wJ.transpose() * J;
  H(2, 2) += prior;
  H(3, 3) += prior;
  const Eigen::LDLT<Eigen::Matrix<double, kUnknowns, kUnknowns>> solver(H.cast<double>());

  SlantedPatch found;
  found.right = start;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::Matrix2f M = SlantedPatch::shear(found.slope);
    if (!inside(right, found.right, kR * (std::abs(M(0, 0)) + std::abs(M(0, 1))), kR)) return {};
    const Samples shown = sample(right, found.right, M);
    Vector6f b = wJ.transpose() * (shown - T);
    b.segment<2>(2) -= prior * found.slope;
    const Vector6f q = solver.solve(b.cast<double>()).cast<float>();
    const float gain = 1.0f + q[4];
    if (!(gain > 0.3f && gain < 3.0f)) return {};
    const Eigen::Vector2f delta = q.head<2>() / gain, e = q.segment<2>(2) / gain;
    // What is at x + delta + (e . x, 0) now is to be at x.
    if (!(e.x() > -0.5f)) return {};
    Eigen::Matrix2f back;
    back << 1.0f / (1.0f + e.x()), -e.y() / (1.0f + e.x()), 0.0f, 1.0f;
    const Eigen::Matrix2f next = M * back;
    found.right -= next * delta;
    found.slope << 1.0f - next(0, 0), -next(0, 1);
    if (!((found.right - start).norm() <= max_shift)) return {};
    if (delta.norm() < kTolerance && e.norm() < kTolerance / 4) return found;
  }
  return {};
}

}  // namespace prospect
