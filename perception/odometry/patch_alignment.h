// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/patch_samples.h"

namespace prospect {

/// A patch of an image, prepared for alignment: the samples T(x) of the image around a centre c,
/// taken at c + A x for the integer offsets x of the patch, and what the normal equations need.
///
/// Model of what another image I shows of it, with the same brightness up to gain and offset:
///   I(p + x) = (1 + alpha) T(x + delta) + beta,   weights w (patch_weight()).
/// Linear in (delta, alpha, beta), with J = [dT/dx, dT/dy, T - mean T, 1] the same in every
/// iteration, so one iteration is one resampling and four dot products (inverse compositional
/// alignment: Baker and Matthews 2004, Lucas and Kanade 1981).
class Patch {
 public:
  /// The patch of `level` around `centre` [px of that level], sampled through the 2 x 2 matrix A.
  /// Empty where the samples leave the image or where its texture does not fix both coordinates:
  /// the smaller eigenvalue of the weighted mean of grad T grad T^T must be >= min_eigenvalue
  /// [grey^2/px^2], once gain and offset are taken out.
  static std::optional<Patch> make(const PyramidLevel& level, const Eigen::Vector2f& centre,
                                   const Eigen::Matrix2f& A, float min_eigenvalue);

  struct Alignment {
    Eigen::Vector2f position = Eigen::Vector2f::Zero();  ///< p [px]
    float gain = 1.0f;                                   ///< 1 + alpha
    /// 1 - (weighted variance of the residual) / (that of the image's patch): 1 is a perfect match.
    float agreement = 0.0f;
    /// Covariance of the position [px^2]. With the residual r of the grey levels, and the normal
    /// equations N = sum w J J^T, sum w = 1, whose part for the position is N', gain and offset
    /// taken out,
    ///   (sum w r^2) (sum w^2) N'^-1  +  s^2 (lambda N'^-1)^2,
    /// lambda the larger eigenvalue of N', s = 0.01 px.
    /// The first part is that of least squares. Residuals of neighbouring pixels are taken to be
    /// independent, which those of a surface that is seen otherwise are not.
    /// The second part is how far the patch slides along an edge. The steps that pixels make of an
    /// edge look like texture along it, but do not move with it: they hold the patch where it was
    /// looked for, and the residual stays small. Their strength is a share of the edge's.
    Eigen::Matrix2f covariance = Eigen::Matrix2f::Zero();
    float residual = 0.0f;  ///< sum w r^2 [grey^2]
    bool converged = false;
  };
  /// Aligns the patch with `level`, from `start`: Gauss-Newton until a step is shorter than
  /// `tolerance` [px] or after max_iterations. Not converged if it leaves the image, moves farther
  /// than max_shift [px] from the start, the brightness inverts, or does not settle.
  Alignment align(const PyramidLevel& level, const Eigen::Vector2f& start, float max_shift,
                  int max_iterations = 20, float tolerance = 0.01f) const;

 private:
  static constexpr int kWidth = 2 * kPatchRadius + 2;  // one padding column: rows of whole vectors
  static constexpr int kRows = 2 * kPatchRadius + 1;
  static constexpr int kSamples = kWidth * kRows;
  using Samples = Eigen::Matrix<float, kSamples, 1>;

  static const Samples& weights();

  Samples T_;
  Samples wJ_[3];  // w J but for the last, which is w; zero in the padding
  Eigen::Matrix4f inverse_;
  Eigen::Vector4f wJT_;  // sum of w J T
  // N'^-1 times sum w^2, and the second part of Alignment::covariance.
  Eigen::Matrix2f spread_, slide_;
};

}  // namespace prospect
