// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/support/instruction_set.h"

namespace prospect {

/// What stays the same for all poses; see FootprintVisibility for the formula. W and C frames, SI
/// units. Members are numbers of one type, and nothing else.
template <typename T>
struct FootprintKernelConstantsOf {
  /// Of half the fields of view, or what stands for them (FootprintVisibility).
  T sin_h, cos_h, sin_v, cos_v;
  T inset;
  T inverse_angle_scale, inverse_range_scale;
  T min_range, max_range;
  T negligible;  ///< g at which P_fov P_range is cut off
  /// Conservative bounds beyond which g is certainly below `negligible`: sine of the angle outside
  /// a horizontal side, squared (above 1: never); squared distance.
  T outside_squared, far_squared;
  T bias_h = T(0), bias_v = T(0);  ///< added to the inset of the horizontal, the vertical sides
};
using FootprintKernelConstants = FootprintKernelConstantsOf<double>;

/// As above.
template <typename T>
struct FootprintKernelPoseOf {
  T sensor[3];  ///< in W
  T R[9];       ///< R_CW, row-major
  T arm[2];     ///< sensor - base, x and y in W
};
using FootprintKernelPose = FootprintKernelPoseOf<double>;

/// Points as arrays; the size of each is FootprintKernel::padded(n).
template <typename T>
struct FootprintPointsOf {
  const T *x, *y, *z;   ///< coordinates [m]
  const T* unoccluded;  ///< P_unoccluded
  int n;
};
/// Those that can have q > 0: their indices in increasing order, and their coordinates in C.
template <typename T>
struct FootprintSelectionOf {
  int* point;
  T *X, *Y, *Z;
};
/// What P_unoccluded of each point is by the sensor's position.
struct UnoccludedSlopes {
  const double *x, *y, *z;
};
/// q of each point, and what it is by the base's position in W and its yaw.
struct FootprintGradient {
  double *q, *d_x, *d_y, *d_z, *d_yaw;
};

/// The loops over points, compiled for several vector widths from one source, all with the same
/// bits.
struct FootprintKernel {
  /// n rounded up to whole vectors of single precision: the size of every array below.
  static constexpr int padded(int n) { return (n + 15) / 16 * 16; }

  using Points = FootprintPointsOf<double>;
  using ScorePoints = FootprintPointsOf<float>;

  /// Picks the points, given in W, that can have q > 0, and returns their number; n values of
  /// P_unoccluded are read. Vectors without one cost a few instructions a point.
  int (*select)(const FootprintKernelConstants& constants, const FootprintKernelPose& pose,
                const Points& points, const FootprintSelectionOf<double>& selected);

  /// q of the selected points, given in C; padding finite.
  void (*value)(const FootprintKernelConstants& constants, const Points& points, double* q);

  /// The same bits of q, and its derivatives.
  void (*gradient)(const FootprintKernelConstants& constants, const FootprintKernelPose& pose,
                   const Points& points, const UnoccludedSlopes& slopes,
                   const FootprintGradient& result);

  /// select() and value() in single precision, for comparing candidates; the sensor's position is
  /// taken from where those of the points are. q is within 6e-6, most of it from exponents cut
  /// at 14.
  int (*select_score)(const FootprintKernelConstants& constants, const FootprintKernelPose& pose,
                      const ScorePoints& points, const FootprintSelectionOf<float>& selected);
  void (*value_score)(const FootprintKernelConstants& constants, const ScorePoints& points,
                      float* q);
};

FootprintKernel footprint_kernel(InstructionSet set);

/// P_fov P_range of one point at (X, Y, Z) in C, cut off.
double footprint_value(const FootprintKernelConstants& constants, double X, double Y, double Z);

}  // namespace prospect
