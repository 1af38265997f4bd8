// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "models/motion_model.h"
#include "models/types.h"

namespace prospect {

/// Shape of the discretised horizon: what a term needs to size its scratch.
struct Horizon {
  const MotionModel* model = nullptr;
  int N = 20;        ///< stages
  double dt = 0.25;  ///< [s]
  int nx() const { return model->nx(); }
  int nu() const { return model->nu(); }
};

class SharedResults;

/// Where the terms that are given a batch of trajectories keep what they share. A copy of the batch
/// points to nothing: it may be altered, or outlive the results.
class SharedResultsPointer {
 public:
  SharedResultsPointer() = default;
  SharedResultsPointer(const SharedResultsPointer&) {}
  SharedResultsPointer& operator=(const SharedResultsPointer& other) {
    if (this != &other) results_ = nullptr;
    return *this;
  }
  SharedResults* get() const { return results_; }

 private:
  friend class SharedResults;
  SharedResults* results_ = nullptr;
};

/// B trajectories over one horizon, structure of arrays (a column is a candidate).
///   states: ((N+1) nx) x B, row k nx + i is x_k[i];   inputs: (N nu) x B, row k nu + j is u_k[j].
/// u_k acts from t_k = k dt to t_{k+1}; x_0 is the present state.
struct TrajectoryBatch {
  Horizon horizon;
  PoseLayout layout;           ///< of horizon.model, fetched once
  Eigen::VectorXd u_previous;  ///< u_{-1}: the input in force now; nu
  BatchArray states;
  BatchArray inputs;
  SharedResultsPointer shared;  ///< set by a Problem; see SharedResults

  int batch() const { return static_cast<int>(states.cols()); }
  double x(int k, int i, int b) const { return states(k * horizon.nx() + i, b); }
  double u(int k, int j, int b) const { return inputs(k * horizon.nu() + j, b); }
  double px(int k, int b) const { return x(k, layout.px, b); }
  double py(int k, int b) const { return x(k, layout.py, b); }
  double pz(int k, int b) const { return layout.pz >= 0 ? x(k, layout.pz, b) : layout.fixed_z; }
  double yaw(int k, int b) const { return x(k, layout.yaw, b); }
  Pose pose(int k, int b) const { return {{px(k, b), py(k, b), pz(k, b)}, yaw(k, b)}; }
};

}  // namespace prospect
