// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/stereo_matcher.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "perception/odometry/patch_alignment.h"
#include "perception/odometry/patch_slope.h"

namespace prospect {
namespace {

constexpr int kR = 5;  // of the correlated patches
constexpr int kSide = 2 * kR + 1;

/// Correlation of the patch of `from` around (u, v) with those of `to` around (x, v), x in
/// [first, last]. The caller keeps all patches inside.
class RowCorrelation {
 public:
  void compute(const PyramidLevel& from, int u, int v, const PyramidLevel& to, int first,
               int last) {
    const int n = last - first + 1;
    float mean = 0.0f;
    for (int y = 0; y < kSide; ++y) {
      const float* row = from.row(v - kR + y) + u - kR;
      for (int x = 0; x < kSide; ++x) mean += patch_[y][x] = row[x];
    }
    mean /= kSide * kSide;
    float energy = 0.0f;
    for (auto& row : patch_) {
      for (float& value : row) {
        value -= mean;
        energy += value * value;
      }
    }
    cross_.assign(n, 0.0f);
    column_sum_.assign(n + 2 * kR, 0.0f);
    column_square_.assign(n + 2 * kR, 0.0f);
    for (int y = 0; y < kSide; ++y) {
      const float* row = to.row(v - kR + y) + first - kR;
      for (int i = 0; i < n + 2 * kR; ++i) {
        // About the patch's mean, so that squares stay small.
        const float value = row[i] - mean;
        column_sum_[i] += value;
        column_square_[i] += value * value;
      }
      for (int x = 0; x < kSide; ++x) {
        const float weight = patch_[y][x];
        for (int i = 0; i < n; ++i) cross_[i] += weight * row[i + x];
      }
    }
    values.resize(n);
    for (int i = 0; i < n; ++i) {
      float sum = 0.0f, square = 0.0f;
      for (int x = 0; x < kSide; ++x) {
        sum += column_sum_[i + x];
        square += column_square_[i + x];
      }
      const float variance = square - sum * sum / (kSide * kSide);
      values[i] = cross_[i] / std::sqrt(std::max(1.0f, variance) * std::max(1.0f, energy));
    }
  }

  std::vector<float> values;

 private:
  float patch_[kSide][kSide];
  std::vector<float> cross_, column_sum_, column_square_;
};

}  // namespace

std::vector<StereoMatch> match_stereo(const ImagePyramid& left, const ImagePyramid& right,
                                      const std::vector<Eigen::Vector2f>& points,
                                      const StereoMatcherOptions& options) {
  std::vector<StereoMatch> matches;
  const PyramidLevel& L = left.level(0);
  const PyramidLevel& R = right.level(0);
  const int reach = static_cast<int>(options.max_disparity * L.width);
  RowCorrelation forward, backward;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int u = static_cast<int>(std::lround(points[i].x()));
    const int v = static_cast<int>(std::lround(points[i].y()));
    if (u < kR || u >= L.width - kR || v < kR || v >= L.height - kR) continue;
    const int first = std::max(kR, u - reach);
    const int last = std::min(u + 1, R.width - 1 - kR);
    if (last <= first) continue;
    forward.compute(L, u, v, R, first, last);
    const auto best = std::max_element(forward.values.begin(), forward.values.end());
    if (*best < options.min_correlation) continue;
    const int at = static_cast<int>(best - forward.values.begin());
    float second = -1.0f;
    for (int k = 0; k < static_cast<int>(forward.values.size()); ++k) {
      if (std::abs(k - at) > 2) second = std::max(second, forward.values[k]);
    }
    if (1.0f - second < options.distinctness * (1.0f - *best)) continue;
    const int x = first + at;
    const int back_first = std::max(kR, x - 1);
    const int back_last = std::min(x + reach, L.width - 1 - kR);
    backward.compute(R, x, v, L, back_first, back_last);
    const auto back = std::max_element(backward.values.begin(), backward.values.end());
    if (std::abs(back_first + static_cast<int>(back - backward.values.begin()) - u) > 1) continue;

    const Eigen::Vector2f& centre = points[i];
    const auto patch = Patch::make(L, centre, Eigen::Matrix2f::Identity(), 0.5f);
    if (!patch) continue;
    const Eigen::Vector2f start(static_cast<float>(x) + centre.x() - u, centre.y());
    const Patch::Alignment facing = patch->align(R, start, 2.5f);
    if (!facing.converged) continue;
    const SlantedPatch slanted =
        align_slanted(L, centre, R, facing.position, facing.residual, 2.5f)
            .value_or(SlantedPatch{facing.position, Eigen::Vector2f::Zero()});
    const Eigen::Matrix2f M = SlantedPatch::shear(slanted.slope);
    const auto warped = Patch::make(L, centre, M.inverse(), 0.5f);
    if (!warped) continue;
    const Patch::Alignment found = warped->align(R, slanted.right, 2.5f);
    if (!found.converged || found.agreement < 0.6f) continue;
    const auto reverse = Patch::make(R, found.position, M, 0.5f);
    if (!reverse) continue;
    const Patch::Alignment returned = reverse->align(L, centre, 2.5f);
    if (!returned.converged) continue;
    if ((returned.position - centre).norm() > options.max_inconsistency) continue;
    StereoMatch match;
    match.index = static_cast<int>(i);
    match.disparity = static_cast<double>(centre.x()) - found.position.x();
    match.row_error = static_cast<double>(found.position.y()) - centre.y();
    match.variance = static_cast<double>(found.covariance(0, 0));
    match.slope = slanted.slope;
    if (match.disparity < options.min_disparity) continue;
    if (std::abs(match.row_error) > options.max_row_error) continue;
    matches.push_back(match);
  }
  return matches;
}

}  // namespace prospect
