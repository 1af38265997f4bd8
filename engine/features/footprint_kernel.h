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

/// The loops over points, compiled for several vector widths from one source, all with the same
/// bits.
struct FootprintKernel {
  /// n rounded up to whole vectors of single precision: the size of every array below.
  static constexpr int padded(int n) { return (n + 15) / 16 * 16; }

  /// Picks the points that can have q > 0: their indices in increasing order and their coordinates
  /// in C; returns their number. Vectors without one cost a few instructions a point.
  /// px, py, pz: in W, padded; occluded: P_unoccluded, n values.
  int (*select)(const FootprintKernelConstants& constants, const FootprintKernelPose& pose,
                const double* px, const double* py, const double* pz, const double* unoccluded,
                int n, int* point, double* X, double* Y, double* Z);

  /// q of the selected points, their P_unoccluded gathered in `unoccluded`; arrays padded, padding
  /// finite.
  void (*value)(const FootprintKernelConstants& constants, const double* X, const double* Y,
                const double* Z, const double* unoccluded, int n, double* q);

  /// The same bits of q, and its derivatives by the base's position in W and its yaw. u_x, u_y,
  /// u_z: derivative of P_unoccluded by the sensor's position.
  void (*gradient)(const FootprintKernelConstants& constants, const FootprintKernelPose& pose,
                   const double* X, const double* Y, const double* Z, const double* unoccluded,
                   const double* u_x, const double* u_y, const double* u_z, int n, double* q,
                   double* d_x, double* d_y, double* d_z, double* d_yaw);

  /// select() and value() in single precision, for comparing candidates; the sensor's position is
  /// taken from where those of the points are. q is within 6e-6, most of it from exponents cut
  /// at 14.
  int (*select_score)(const FootprintKernelConstants& constants, const FootprintKernelPose& pose,
                      const float* px, const float* py, const float* pz, const float* unoccluded,
                      int n, int* point, float* X, float* Y, float* Z);
  void (*value_score)(const FootprintKernelConstants& constants, const float* X, const float* Y,
                      const float* Z, const float* unoccluded, int n, float* q);
};

FootprintKernel footprint_kernel(InstructionSet set);

/// P_fov P_range of one point at (X, Y, Z) in C, cut off.
double footprint_value(const FootprintKernelConstants& constants, double X, double Y, double Z);

}  // namespace prospect
