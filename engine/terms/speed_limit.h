// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "engine/problem/term.h"

namespace prospect {

/// Bounds on velocities that are part of the state, where bounds on the input do not hold them:
///
///   row (k-1) n + i:   c_i(x_k) >= 0   [m/s or rad/s],   k = 1..N, i = 0..n-1
///
/// with c the n rows of MotionModel::state_constraints(). The present state, k = 0, cannot be
/// chosen. A velocity-controlled model has none: no rows. Smooth. Thread-safety: immutable;
/// concurrent calls need separate scratch. Source: formulation, section 1 (bounds).
class SpeedLimit : public Term {
 public:
  explicit SpeedLimit(const MotionModel& model) : rows_(model.num_state_constraints()) {}

  std::string_view name() const override { return "speed_limit"; }
  TermTraits traits() const override;
  int rows(const Horizon& horizon) const override { return horizon.N * rows_; }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon& horizon) const override;
  std::unique_ptr<TermScratch> make_scratch(const Horizon& horizon, int max_batch) const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

 private:
  struct Scratch;
  int rows_;
};

}  // namespace prospect
