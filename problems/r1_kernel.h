// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/support/instruction_set.h"

namespace prospect {

/// A value at a planar pose and its derivatives by (px, py, theta).
struct R1Value {
  double value = 0.0, d_px = 0.0, d_py = 0.0, d_theta = 0.0;
};

struct R1Pose {
  double px, py, cos_theta, sin_theta;
};

/// The sums of R1 (see r1.h) over points at one pose, compiled for several vector widths from one
/// source, all with the same bits. Arrays are padded to whole blocks of kLanes with what adds
/// nothing (below 1e-22). The functions with a gradient give the same bits of the value.
///
/// The sigmoids of both image borders share one exponential, a = e^(-u/10): s(u) s(640-u) =
/// a / ((1+a) (a+e^-64)); exponents are clamped to +-100, which moves a value by less than 1e-22,
/// so that a point far off the image gives zero derivatives, not NaN.
///
/// The scores are the same sums in single precision, for comparing candidates, to 3e-6 of the
/// number of points. Where e^-64 is nothing, s(u) s(640-u) is one sigmoid of |u - 320|.
struct R1Kernel {
  static constexpr int padded(int n) { return (n + 15) / 16 * 16; }

  using Points = R1Value (*)(const R1Pose& pose, const double* x, const double* y,
                             const double* down, int n);
  using Discs = R1Value (*)(const R1Pose& pose, const double* x, const double* y, int n);

  /// Expected number of points in view, n. down: height of the camera less that of the point [m].
  Points visible, visible_gradient;
  /// sum 0.5 (1 - tanh(8 (d - 0.35))), d = distance to the centre - 0.25.
  Discs collision, collision_gradient;
  /// sum exp(-|q - b|^2 / (2 0.8^2)) at the point q, 1.5 m ahead.
  Discs gain, gain_gradient;

  double (*visible_score)(const R1Pose& pose, const float* x, const float* y, const float* down,
                          int n);
  double (*collision_score)(const R1Pose& pose, const float* x, const float* y, int n);
  double (*gain_score)(const R1Pose& pose, const float* x, const float* y, int n);
};

R1Kernel r1_kernel(InstructionSet set);

}  // namespace prospect
