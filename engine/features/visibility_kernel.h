// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

namespace prospect {

/// Landmarks that fill the widest vector, structure of arrays; what the kernel reads of each.
/// Padding has survival 0. Position in W, or, with float, from a point near all of them, so that
/// no digits are lost far from the origin. SI units.
template <typename T>
struct alignas(64) VisibilityBlockOf {
  static constexpr int kLanes = 64 / sizeof(T);
  using Lanes = T[kLanes];
  Lanes x, y, z;                 ///< l_i
  Lanes xx, xy, xz, yy, yz, zz;  ///< Sigma_i
  Lanes nx, ny, nz;              ///< creation direction
  Lanes inverse_creation_range;
  Lanes survival;      ///< tau_i
  Lanes multiplicity;  ///< mu_i
  Lanes per_cell;      ///< c_i [1/m^2]
};
using VisibilityBlock = VisibilityBlockOf<double>;
using VisibilityScoreBlock = VisibilityBlockOf<float>;

/// What stays the same for all stages. Members are numbers of one type, and nothing else.
template <typename T>
struct VisibilityKernelConstantsOf {
  T fx, fy, fx_baseline;
  T u_min, u_max, v_min, v_max;  ///< trackable image area, relative to the principal point [px]
  T pixel_variance;              ///< sigma_px^2
  T border_variance;             ///< border_sigma_px^2
  T near_depth;                  ///< gate: 0 up to here, 1 from twice this on [m]
  T r_min, r_max, inverse_r_min_width, inverse_r_max_width;
  T scale_min, scale_max, inverse_scale_width;
  T cos_view, inverse_cos_width;
  T up[3];     ///< z axis of B, in C
  T lever[3];  ///< g_0: dY/dyaw = Y x up + g_0
};
using VisibilityKernelConstants = VisibilityKernelConstantsOf<double>;

/// What changes from stage to stage: where the camera is and how well this is known. As above.
template <typename T>
struct VisibilityKernelStageOf {
  T sensor[3];  ///< camera centre, where the landmarks' positions are
  T R[9];       ///< R_CW, row-major
  /// Sigma_rel of Y = R_CW (l - sensor), split by cause: dY = rho + (dY/dyaw) dyaw,
  T M[6];  ///< cov(rho), in C: xx, yy, zz, xy, xz, yz
  T c[3];  ///< cov(rho, yaw), in C
  T s;     ///< var(yaw)
};
using VisibilityKernelStage = VisibilityKernelStageOf<double>;

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

/// The same for scores: pi_i alone.
struct alignas(64) VisibilityScoreResult {
  float pi[VisibilityScoreBlock::kLanes];
  bool alive;  ///< false: all are exactly 0
};

/// Sums over all landmarks.
struct VisibilitySums {
  double count;                                      ///< sum mu pi
  double variance;                                   ///< sum mu pi (1 - pi)
  double d_count[visibility_derivative::kCount];     ///< with gradient
  double d_variance[visibility_derivative::kCount];  ///< with gradient
};

/// P_unoccluded and its derivative by the sensor's position; arrays of 8 times the number of
/// blocks. Without derivatives nothing else has one.
template <typename T>
struct UnoccludedInputOf {
  const T* probability;
  const T* d_x = nullptr;
  const T* d_y = nullptr;
  const T* d_z = nullptr;
};
using UnoccludedInput = UnoccludedInputOf<double>;

/// The loops over landmarks, compiled for several vector widths from one source. All of them give
/// the same bits: sums run in eight lanes whatever the width.
///
/// Landmarks whose pi is exactly 0 (behind the near plane, or with no free line of sight) or below
/// what a sum can hold (9 standard deviations outside the image, 40 logistic widths beyond r_max)
/// are skipped in blocks of eight.
struct VisibilityKernel {
  std::string_view name;  ///< "generic", "avx2", "avx512"

  /// results: one per block, with derivatives if `unoccluded` has them.
  void (*evaluate)(const VisibilityBlock* blocks, int num_blocks,
                   const VisibilityKernelConstants& constants, const VisibilityKernelStage& stage,
                   const UnoccludedInput& unoccluded, VisibilityBlockResult* results,
                   VisibilitySums& sums);

  /// Count and variance alone, in single precision, for comparing candidates: pi to about 1e-6.
  /// `stage.sensor` is taken from where the blocks' positions are; `unoccluded`:
  /// VisibilityScoreBlock::kLanes values a block; results: one per block.
  void (*score)(const VisibilityScoreBlock* blocks, int num_blocks,
                const VisibilityKernelConstants& constants, const VisibilityKernelStage& stage,
                const float* unoccluded, VisibilityScoreResult* results, VisibilitySums& sums);

  /// information (6 x 6, row-major, symmetric, overwritten) = sum_i mu_i pi_i H_i^T S_i^-1 H_i,
  /// after evaluate() for the same stage.
  void (*information)(const VisibilityBlock* blocks, int num_blocks,
                      const VisibilityKernelConstants& constants,
                      const VisibilityKernelStage& stage, const VisibilityBlockResult* results,
                      double* information);

  /// The same, but for pi_i, which score() has found: `num_blocks` of `blocks` are as many
  /// landmarks, in the same order. In single precision the determinant is off by up to 1e-3 where
  /// the information is weak.
  void (*score_information)(const VisibilityBlock* blocks, int num_blocks,
                            const VisibilityKernelConstants& constants,
                            const VisibilityKernelStage& stage,
                            const VisibilityScoreResult* results, double* information);

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
