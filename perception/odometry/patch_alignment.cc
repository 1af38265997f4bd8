// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/patch_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace prospect {
namespace {

constexpr int kR = kPatchRadius;
constexpr double kSlide = 0.01;  // s of Patch::Alignment [px]

}  // namespace

const Patch::Samples& Patch::weights() {
  static const Samples weights = [] {
    Samples w = Samples::Zero();
    for (int y = -kR; y <= kR; ++y) {
      for (int x = -kR; x <= kR; ++x) {
        w[(y + kR) * kWidth + x + kR] = patch_weight(x, y);
      }
    }
    return Samples(w / w.sum());
  }();
  return weights;
}

std::optional<Patch> Patch::make(const PyramidLevel& level, const Eigen::Vector2f& centre,
                                 const Eigen::Matrix2f& A, float min_eigenvalue) {
  // One sample more on every side, for the gradients.
  constexpr int kBorder = kR + 1;
  constexpr int kSide = 2 * kBorder + 1;
  const float reach_x = kBorder * (std::abs(A(0, 0)) + std::abs(A(0, 1)));
  const float reach_y = kBorder * (std::abs(A(1, 0)) + std::abs(A(1, 1)));
  // Written so that NaN fails.
  if (!(centre.x() - reach_x >= 0 && centre.x() + reach_x < level.width - 1 &&
        centre.y() - reach_y >= 0 && centre.y() + reach_y < level.height - 1)) {
    return std::nullopt;
  }
  const auto raw = sample_square<kBorder>(level, centre, A);
  std::optional<Patch> made(std::in_place);
  Patch& patch = *made;
  Samples J[3];
  // The padding holds samples of other columns; its weight is 0.
  for (int y = 0; y < kRows; ++y) {
    const float* above = raw.data() + y * kSide + 1;
    const float* here = above + kSide;
    const float* below = here + kSide;
    for (int x = 0; x < kWidth; ++x) {
      const int k = y * kWidth + x;
      patch.T_[k] = here[x];
      J[0][k] = 0.5f * (here[x + 1] - here[x - 1]);
      J[1][k] = 0.5f * (below[x] - above[x]);
    }
  }
  const Samples& w = weights();
  const float mean = w.dot(patch.T_);
  J[2] = patch.T_.array() - mean;
  Eigen::Matrix4d H;
  for (int i = 0; i < 3; ++i) {
    patch.wJ_[i] = w.cwiseProduct(J[i]);
    patch.wJT_[i] = patch.wJ_[i].dot(patch.T_);
    for (int j = 0; j <= i; ++j) H(i, j) = H(j, i) = patch.wJ_[j].dot(J[i]);
    H(i, 3) = H(3, i) = patch.wJ_[i].sum();
  }
  patch.wJT_[3] = mean;
  H(3, 3) = w.sum();
  // Texture that is left for the position when gain and offset are free: the Schur complement.
  if (!(H(2, 2) > 1e-3)) return std::nullopt;
  const Eigen::Matrix2d position =
      H.topLeftCorner<2, 2>() -
      H.topRightCorner<2, 2>() * H.bottomRightCorner<2, 2>().inverse() * H.bottomLeftCorner<2, 2>();
  const double half_trace = 0.5 * position.trace();
  const double smaller =
      half_trace - std::sqrt(std::max(0.0, half_trace * half_trace - position.determinant()));
  if (!(smaller >= min_eigenvalue) || !(smaller > 1e-6 * half_trace)) return std::nullopt;
  patch.inverse_ = H.inverse().cast<float>();
  const Eigen::Matrix2d inverse = position.inverse();
  const double larger = 2.0 * half_trace - smaller;
  patch.spread_ = (w.squaredNorm() * inverse).cast<float>();
  patch.slide_ = (kSlide * kSlide * larger * larger * inverse * inverse).cast<float>();
  return made;
}

Patch::Alignment Patch::align(const PyramidLevel& level, const Eigen::Vector2f& start,
                              float max_shift, int max_iterations, float tolerance) const {
  Alignment result;
  result.position = start;
  Samples I;
  const Samples& w = weights();
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Eigen::Vector2f p = result.position;
    if (!(p.x() >= kR && p.x() < level.width - kR - 2 && p.y() >= kR &&
          p.y() < level.height - kR - 1)) {
      return result;
    }
    const int u = static_cast<int>(p.x()), v = static_cast<int>(p.y());
    const float a = p.x() - u, b = p.y() - v;
    const float w00 = (1 - a) * (1 - b), w01 = a * (1 - b), w10 = (1 - a) * b, w11 = a * b;
    for (int y = 0; y < kRows; ++y) {
      const float* top = level.row(v - kR + y) + u - kR;
      const float* bottom = top + level.width;
      float* out = I.data() + y * kWidth;
      for (int x = 0; x < kWidth; ++x) {
        out[x] = w00 * top[x] + w01 * top[x + 1] + w10 * bottom[x] + w11 * bottom[x + 1];
      }
    }
    const Eigen::Vector4f difference =
        Eigen::Vector4f(wJ_[0].dot(I), wJ_[1].dot(I), wJ_[2].dot(I), w.dot(I)) - wJT_;
    const Eigen::Vector4f solution = inverse_ * difference;
    result.gain = 1.0f + solution[2];
    if (!(result.gain > 0.3f && result.gain < 3.0f)) return result;
    const Eigen::Vector2f step = -solution.head<2>() / result.gain;
    result.position += step;
    if (!((result.position - start).norm() <= max_shift)) return result;
    if (step.squaredNorm() < tolerance * tolerance) {
      // Residual at the point before the last, tiny step, and after the linear model.
      const float mean = w.dot(I);
      const float variance = w.dot(I.cwiseProduct(I)) - mean * mean;
      const float explained = solution.dot(difference);
      const float total = w.dot((I - T_).cwiseProduct(I - T_));
      const float unexplained = std::max(0.0f, total - explained);
      result.agreement = 1.0f - unexplained / std::max(variance, 1e-3f);
      result.residual = unexplained;
      result.covariance = unexplained / (result.gain * result.gain) * spread_ + slide_;
      result.converged = true;
      return result;
    }
  }
  return result;
}

}  // namespace prospect
