// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/support/instruction_set.h"

namespace prospect {

/// One plane (fixed z) of the tensor-product B-spline of an OcclusionTable: 3 x 3 rows with their
/// weights.
struct OcclusionPlane {
  const float* rows[9];     ///< V of all points at node (a, b): rows[3 b + a], padded
  double x[3], y[3], z;     ///< weights
  double dx[3], dy[3], dz;  ///< their derivatives [1/m]
};

/// out_i (+)= z sum_b y_b sum_a x_a rows_ba[i], i < n, and the derivatives where they are not null
/// (d_x and d_y together; d_z only with them). `first`: writes instead of adding. The value has the
/// same bits with and without derivatives, and with every instruction set.
using OcclusionKernel = void (*)(const OcclusionPlane& plane, int n, bool first, double* out,
                                 double* d_x, double* d_y, double* d_z);

OcclusionKernel occlusion_kernel(InstructionSet set);

/// The value alone in single precision, within 1e-6 for values up to 1; the same bits with every
/// instruction set.
using OcclusionScoreKernel = void (*)(const OcclusionPlane& plane, int n, bool first, float* out);

OcclusionScoreKernel occlusion_score_kernel(InstructionSet set);

}  // namespace prospect
