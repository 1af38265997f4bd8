// SPDX-License-Identifier: Apache-2.0
#include "perception/graph/graph_solver.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "perception/odometry/se3.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Map;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
template <int Rows, int Columns>
using RowMajor = Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor>;
using RowMajorColumns = Eigen::Matrix<double, 7, Eigen::Dynamic, Eigen::RowMajor>;
using PoseBlock = std::array<double, 7>;  // position, quaternion with w last

Isometry3d pose_of(const double* x) {
  Isometry3d T = Isometry3d::Identity();
  T.translation() = Map<const Vector3d>(x);
  T.linear() = Map<const Quaterniond>(x + 3).toRotationMatrix();
  return T;
}

// Of q (1, omega / 2) by omega, x y z w.
Eigen::Matrix<double, 4, 3> quaternion_derivative(const double* q) {
  Eigen::Matrix<double, 4, 3> Q;
  Q << q[3], -q[2], q[1],  //
      q[2], q[3], -q[0],   //
      -q[1], q[0], q[3],   //
      -q[0], -q[1], -q[2];
  return 0.5 * Q;
}

// The left inverse of PoseManifold::PlusJacobian: times it, a derivative by xi is one by x.
RowMajor<6, 7> tangent_of(const double* x) {
  RowMajor<6, 7> J;
  J.setZero();
  J.topLeftCorner<3, 3>() = Map<const Quaterniond>(x + 3).toRotationMatrix().transpose();
  J.bottomRightCorner<3, 4>() = 4.0 * quaternion_derivative(x + 3).transpose();
  return J;
}

// T (exp(omega), t): the derivative is that of T exp(xi).
class PoseManifold final : public ceres::Manifold {
 public:
  explicit PoseManifold(std::vector<int> directions) : directions_(std::move(directions)) {}
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return static_cast<int>(directions_.size()); }
  bool Plus(const double* x, const double* delta, double* moved) const override {
    Vector6d xi = Vector6d::Zero();
    for (std::size_t k = 0; k < directions_.size(); ++k) xi[directions_[k]] = delta[k];
    const Map<const Quaterniond> q(x + 3);
    const double half = 0.5 * xi.tail<3>().norm();
    const double s = half < 1e-8 ? 0.5 : 0.5 * std::sin(half) / half;
    Quaterniond turn;
    turn.w() = std::cos(half);
    turn.vec() = s * xi.tail<3>();
    Map<Vector3d>{moved} = Map<const Vector3d>(x) + q * Vector3d(xi.head<3>());
    Map<Quaterniond>{moved + 3} = (q * turn).normalized();
    return true;
  }
  bool PlusJacobian(const double* x, double* jacobian) const override {
    Eigen::Matrix<double, 7, 6> J = Eigen::Matrix<double, 7, 6>::Zero();
    J.topLeftCorner<3, 3>() = Map<const Quaterniond>(x + 3).toRotationMatrix();
    J.bottomRightCorner<4, 3>() = quaternion_derivative(x + 3);
    Map<RowMajorColumns> columns(jacobian, 7, TangentSize());
    for (int k = 0; k < TangentSize(); ++k) {
      columns.col(k) = J.col(directions_[static_cast<std::size_t>(k)]);
    }
    return true;
  }
  // What Ceres asks of poses that it moves is all above.
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }

 private:
  std::vector<int> directions_;
};

class EdgeCost final : public ceres::CostFunction {
 public:
  explicit EdgeCost(const GraphEdge& edge) : edge_(edge) {
    set_num_residuals(6);
    *mutable_parameter_block_sizes() = {7, 7};
    if (edge.odometry) mutable_parameter_block_sizes()->push_back(6);
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Matrix6d by[2];
    const bool derive = jacobians != nullptr;
    Vector6d e = measurement_error(pose_of(x[0]), pose_of(x[1]), edge_.T, derive ? &by[0] : nullptr,
                                   derive ? &by[1] : nullptr);
    if (edge_.odometry) e -= edge_.drift * Map<const Vector6d>(x[2]);
    Map<Vector6d>{residuals} = edge_.root * e;
    if (!derive) return true;
    for (int k = 0; k < 2; ++k) {
      if (jacobians[k] == nullptr) continue;
      Map<RowMajor<6, 7>>{jacobians[k]} = edge_.root * by[k] * tangent_of(x[k]);
    }
    if (edge_.odometry && jacobians[2] != nullptr) {
      Map<RowMajor<6, 6>>{jacobians[2]} = -edge_.root * edge_.drift;
    }
    return true;
  }

 private:
  const GraphEdge& edge_;
};

class DriftPrior final : public ceres::SizedCostFunction<6, 6> {
 public:
  explicit DriftPrior(double sigma) : sigma_(sigma) {}
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Map<Vector6d>{residuals} = Map<const Vector6d>(x[0]) / sigma_;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Map<RowMajor<6, 6>>{jacobians[0]} = Matrix6d::Identity() / sigma_;
    }
    return true;
  }

 private:
  double sigma_;
};

}  // namespace

GraphEdge loop_edge(int a, int b, const RelativePose& measured) {
  GraphEdge edge;
  edge.a = a;
  edge.b = b;
  edge.T = measured.T;
  edge.root = Eigen::LLT<Matrix6d>(measured.information).matrixU();
  return edge;
}

std::vector<int> GraphEstimate::directions() const {
  return planar ? std::vector<int>{0, 1, 5} : std::vector<int>{0, 1, 2, 3, 4, 5};
}

Vector6d whitened_error(const GraphEdge& edge, const GraphEstimate& estimate, Matrix6d* by_b) {
  Vector6d e =
      measurement_error(estimate.poses[static_cast<std::size_t>(edge.a)],
                        estimate.poses[static_cast<std::size_t>(edge.b)], edge.T, nullptr, by_b);
  if (edge.odometry) e -= edge.drift * estimate.beta;
  if (by_b != nullptr) *by_b = edge.root * *by_b;
  return edge.root * e;
}

bool solve_graph(const std::vector<const GraphEdge*>& edges, double drift_sigma, double tolerance,
                 GraphBudget& budget, GraphEstimate& estimate) {
  std::vector<PoseBlock> blocks(estimate.poses.size());
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    Map<Vector3d>{blocks[k].data()} = estimate.poses[k].translation();
    Map<Quaterniond>{blocks[k].data() + 3} = Quaterniond(estimate.poses[k].linear()).normalized();
  }
  Vector6d beta = estimate.beta;
  PoseManifold manifold(estimate.directions());
  ceres::Problem::Options own;
  own.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  own.disable_all_safety_checks = true;  // half of the time to build it
  ceres::Problem problem(own);
  for (PoseBlock& block : blocks) problem.AddParameterBlock(block.data(), 7, &manifold);
  problem.SetParameterBlockConstant(blocks.front().data());
  problem.AddResidualBlock(new DriftPrior(drift_sigma), nullptr, beta.data());
  for (const GraphEdge* edge : edges) {
    std::vector<double*> parameters = {blocks[static_cast<std::size_t>(edge->a)].data(),
                                       blocks[static_cast<std::size_t>(edge->b)].data()};
    if (edge->odometry) parameters.push_back(beta.data());
    problem.AddResidualBlock(new EdgeCost(*edge), nullptr, parameters);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.max_num_iterations = std::clamp(budget.iterations, 1, 50);
  options.logging_type = ceres::SILENT;
  options.function_tolerance = tolerance;
  if (budget.deadline != std::chrono::steady_clock::time_point::max()) {
    const std::chrono::duration<double> left = budget.deadline - std::chrono::steady_clock::now();
    options.max_solver_time_in_seconds = std::max(0.0, left.count());
  }
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  budget.iterations -= std::max(1, static_cast<int>(summary.iterations.size()) - 1);
  if (summary.IsSolutionUsable()) {
    for (std::size_t k = 0; k < blocks.size(); ++k) estimate.poses[k] = pose_of(blocks[k].data());
    estimate.beta = beta;
  }
  // What fifty iterations do not bring to an end, more do not either.
  return summary.termination_type != ceres::NO_CONVERGENCE ||
         static_cast<int>(summary.iterations.size()) > 50;
}

}  // namespace prospect
