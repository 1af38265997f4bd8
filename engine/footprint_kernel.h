#pragma once

#include "engine/instruction_set.h"

namespace prospect {

/// What stays the same for all poses; see FootprintVisibility for the formula. W and C frames, SI
/// units.
struct FootprintKernelConstants {
  double sin_h, cos_h, sin_v, cos_v;  ///< of half the fields of view
  double inset;
  double inverse_angle_scale, inverse_range_scale;
  double min_range, max_range;
  double negligible;  ///< g at which P_fov P_range is cut off
  /// Conservative bounds beyond which g is certainly below `negligible`: sine of the angle outside
  /// a horizontal side, squared (above 1: never); squared distance.
  double outside_squared, far_squared;
};

struct FootprintKernelPose {
  double sensor[3];  ///< in W
  double R[9];       ///< R_CW, row-major
  double arm[2];     ///< sensor - base, x and y in W
};

/// The loops over points, compiled for several vector widths from one source, all with the same
/// bits.
struct FootprintKernel {
  static constexpr int kLanes = 8;
  /// n rounded up to whole blocks of kLanes: the size of every array below.
  static constexpr int padded(int n) { return (n + kLanes - 1) / kLanes * kLanes; }

  /// Picks the points that can have q > 0: their indices in increasing order and their coordinates
  /// in C; returns their number. Blocks of eight without one cost a few instructions a point.
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
};

FootprintKernel footprint_kernel(InstructionSet set);

/// P_fov P_range of one point at (X, Y, Z) in C, cut off.
double footprint_value(const FootprintKernelConstants& constants, double X, double Y, double Z);

}  // namespace prospect
