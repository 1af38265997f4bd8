#pragma once

#include <string_view>
#include <vector>

namespace prospect {

/// Eight landmarks, structure of arrays; what the kernel reads of each. Padding has survival 0.
/// W frame, SI units.
struct alignas(64) VisibilityBlock {
  static constexpr int kLanes = 8;
  double x[8], y[8], z[8];                          ///< l_i
  double xx[8], xy[8], xz[8], yy[8], yz[8], zz[8];  ///< Sigma_i
  double nx[8], ny[8], nz[8];                       ///< creation direction
  double inverse_creation_range[8];
  double survival[8];      ///< tau_i
  double multiplicity[8];  ///< mu_i
};

/// What stays the same for all stages.
struct VisibilityKernelConstants {
  double fx, fy, fx_baseline;
  double u_min, u_max, v_min,
      v_max;               ///< trackable image area, relative to the principal point [px]
  double pixel_variance;   ///< sigma_px^2
  double border_variance;  ///< border_sigma_px^2
  double near_depth;       ///< gate: 0 up to here, 1 from twice this on [m]
  double r_min, r_max, inverse_r_min_width, inverse_r_max_width;
  double scale_min, scale_max, inverse_scale_width;
  double cos_view, inverse_cos_width;
  double up[3];     ///< z axis of B, in C
  double lever[3];  ///< g_0: dY/dyaw = Y x up + g_0
};

/// What changes from stage to stage: where the camera is and how well this is known.
struct VisibilityKernelStage {
  double sensor[3];  ///< camera centre in W
  double R[9];       ///< R_CW, row-major
  /// Sigma_rel of Y = R_CW (l - sensor), split by cause: dY = rho + (dY/dyaw) dyaw,
  double M[6];  ///< cov(rho), in C: xx, yy, zz, xy, xz, yz
  double c[3];  ///< cov(rho, yaw), in C
  double s;     ///< var(yaw)
};

/// The quantities with respect to which the kernel differentiates. Off-diagonal entries of M count
/// as one variable for both places of the symmetric matrix.
namespace visibility_derivative {
enum Index {
  kCamera = 0,  ///< 3: displacement of Y in C, with the camera's position in W held for views
  kSensor = 3,  ///< 3: position of the camera in W, where it is not through Y (view, occlusion)
  kYaw = 6,  ///< everything that turns with the base, but for M, c and the position of the camera
  kM = 7,    ///< 6
  kC = 13,   ///< 3
  kS = 16,
  kCount = 17
};
}

/// Per block of landmarks: pi_i and its derivatives.
struct alignas(64) VisibilityBlockResult {
  double pi[8];
  double d[visibility_derivative::kCount][8];
  bool alive;  ///< false: all eight are exactly 0 with their derivatives; d is not written
};

/// Sums over all landmarks.
struct VisibilitySums {
  double count;                                      ///< sum mu pi
  double variance;                                   ///< sum mu pi (1 - pi)
  double d_count[visibility_derivative::kCount];     ///< with gradient
  double d_variance[visibility_derivative::kCount];  ///< with gradient
};

/// P_unoccluded and its derivative by the sensor's position; arrays of 8 times the number of
/// blocks.
struct UnoccludedInput {
  const double* probability;
  const double* d_x;
  const double* d_y;
  const double* d_z;
};

/// The loops over landmarks, compiled for several vector widths from one source. All of them give
/// the same bits: sums run in eight lanes whatever the width.
///
/// Landmarks whose pi is exactly 0 (behind the near plane, or with no free line of sight) or below
/// what a sum can hold (9 standard deviations outside the image, 40 logistic widths beyond r_max)
/// are skipped in blocks of eight.
struct VisibilityKernel {
  std::string_view name;  ///< "generic", "avx2", "avx512"

  /// results: one per block.
  void (*evaluate)(const VisibilityBlock* blocks, int num_blocks,
                   const VisibilityKernelConstants& constants, const VisibilityKernelStage& stage,
                   const UnoccludedInput& unoccluded, bool gradient, VisibilityBlockResult* results,
                   VisibilitySums& sums);

  /// information (6 x 6, row-major, symmetric, overwritten) = sum_i mu_i pi_i H_i^T S_i^-1 H_i,
  /// after evaluate() for the same stage.
  void (*information)(const VisibilityBlock* blocks, int num_blocks,
                      const VisibilityKernelConstants& constants,
                      const VisibilityKernelStage& stage, const VisibilityBlockResult* results,
                      double* information);

  /// d[kCount] (overwritten) = derivatives of sum_ab P_ab information_ab for a symmetric P (6 x 6);
  /// after evaluate() with gradient.
  void (*information_gradient)(const VisibilityBlock* blocks, int num_blocks,
                               const VisibilityKernelConstants& constants,
                               const VisibilityKernelStage& stage,
                               const VisibilityBlockResult* results, const double* P, double* d);
};

/// Those that this processor can run, narrowest first.
std::vector<VisibilityKernel> available_visibility_kernels();
/// The widest.
VisibilityKernel best_visibility_kernel();

}  // namespace prospect
