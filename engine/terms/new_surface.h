// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "engine/problem/term.h"
#include "engine/problem/trajectory.h"

namespace prospect {

/// Expected surface that the camera sees for the first time at each stage of a trajectory: what the
/// prior for points not mapped yet is proportional to. Implemented where newly seen space is
/// computed; used by the terms that predict visible features.
///
/// The surface first seen at stage k may depend on the poses of all stages up to k (nothing is seen
/// for the first time twice), so the derivative is offered as a product with an adjoint.
///
/// Thread-safety: const; concurrent calls need separate scratch. No allocation after the first call
/// with a scratch. Writes finite numbers.
/// Source: formulation, section 3 (prior).
class NewSurface {
 public:
  virtual ~NewSurface() = default;

  virtual std::unique_ptr<TermScratch> make_scratch(const Horizon&, int /*max_batch*/) const {
    return nullptr;
  }

  /// Writes A_k [m^2] >= 0, k = 0..N (N + 1 values), of candidate b.
  virtual void evaluate(const TrajectoryBatch& trajectories, int b, TermScratch* scratch,
                        double* area) const = 0;

  /// Adds sum_k adjoint[k] dA_k/dx into out's gradients of candidate b (N + 1 adjoints). Called
  /// right after evaluate() with the same trajectory, b and scratch.
  virtual void add_gradient(const TrajectoryBatch& trajectories, int b, TermScratch* scratch,
                            const double* adjoint, TermOutput& out) const = 0;
};

}  // namespace prospect
