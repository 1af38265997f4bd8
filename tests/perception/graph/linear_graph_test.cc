// SPDX-License-Identifier: Apache-2.0
#include "perception/graph/linear_graph.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <vector>

#include "perception/graph/odometry_tree.h"
#include "perception/odometry/se3.h"
#include "tests/perception/graph/two_laps.h"

namespace prospect::linear_graph_test {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using test::TwoLaps;

constexpr double kDrift = 0.1;

/// A short way in 3-D with a loop, and the rows of its least squares in full.
struct ShortWay {
  ShortWay() {
    const TwoLaps laps(1, false);
    for (int k = 0; k < 8; ++k) estimate.poses.push_back(laps.truth[static_cast<std::size_t>(k)]);
    std::vector<KeyframeStep> tree(1);
    for (int k = 0; k < 7; ++k) tree.push_back({k, laps.odometry[static_cast<std::size_t>(k)]});
    edges = odometry_edges(tree);
    RelativePose loop = {laps.between(6, 1), 100.0 * Matrix6d::Identity()};
    edges.push_back(loop_edge(6, 1, loop));
    for (const GraphEdge& edge : edges) pointers.push_back(&edge);
  }
  /// H by differences of the whitened errors.
  Eigen::MatrixXd information() const {
    const int n = 6 * 8;
    Eigen::MatrixXd J(6 * static_cast<int>(edges.size()) + 6, n);
    constexpr double kStep = 1e-5;
    for (int column = 0; column < n; ++column) {
      const auto moved = [&](double by) {
        GraphEstimate x = estimate;
        const int pose = column / 6 + 1;
        const Vector6d step = by * Vector6d::Unit(column % 6);
        if (pose < 8) {
          x.poses[static_cast<std::size_t>(pose)] =
              x.poses[static_cast<std::size_t>(pose)] * exp_se3(step);
        } else {
          x.beta += step;
        }
        Eigen::VectorXd r(J.rows());
        for (std::size_t e = 0; e < edges.size(); ++e) {
          r.segment<6>(6 * static_cast<int>(e)) = whitened_error(edges[e], x);
        }
        r.tail<6>() = x.beta / kDrift;
        return r;
      };
      J.col(column) = (moved(kStep) - moved(-kStep)) / (2.0 * kStep);
    }
    return J.transpose() * J;
  }
  std::vector<GraphEdge> edges;
  std::vector<const GraphEdge*> pointers;
  GraphEstimate estimate;
};

TEST(LinearGraph, CovariancesAreThoseOfTheWholeInverse) {
  const ShortWay way;
  const LinearGraph graph(way.pointers, kDrift, way.estimate);
  ASSERT_TRUE(graph.ok());
  const Eigen::MatrixXd covariance = way.information().inverse();
  for (const auto& [a, b] : {std::pair{0, 7}, {3, 7}, {5, 2}}) {
    const LinearGraph::Change change = graph.change(a, b);
    Eigen::MatrixXd D = Eigen::MatrixXd::Zero(6, 48);
    D.middleCols<6>(6 * (b - 1)) = Matrix6d::Identity();
    if (a > 0) D.middleCols<6>(6 * (a - 1)) = -change.reach;
    const Matrix6d expected = D * covariance * D.transpose();
    const Matrix6d found = graph.covariance(change, graph.response(change));
    EXPECT_LT((found - expected).norm(), 1e-6 * expected.norm()) << a << ' ' << b;
  }
}

TEST(LinearGraph, SamplesHaveTheGraphsCovariance) {
  const ShortWay way;
  const LinearGraph graph(way.pointers, kDrift, way.estimate);
  const LinearGraph::Change change = graph.change(0, 7);
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  Matrix6d sampled = Matrix6d::Zero();
  constexpr int kSamples = 4000;
  Eigen::VectorXd z(graph.size());
  for (int i = 0; i < kSamples; ++i) {
    for (double& value : z) value = normal(generator);
    const Vector6d d = graph.value(change, graph.sample(z));
    sampled += d * d.transpose() / kSamples;
  }
  const Matrix6d expected = graph.covariance(change, graph.response(change));
  EXPECT_LT((sampled - expected).norm(), 0.1 * expected.norm());
}

TEST(LinearGraph, OneStepSolvesWhatIsLinear) {
  // Errors of the measurements come back as those of the edges, by least squares.
  const ShortWay way;
  const LinearGraph graph(way.pointers, kDrift, way.estimate);
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(graph.size(), -1.0, 1.0);
  std::vector<Vector6d> w;
  for (std::size_t e = 0; e < graph.edges(); ++e) w.push_back(graph.whitened_change(e, x));
  const Eigen::VectorXd found = graph.least_squares(w, x.tail<6>() / kDrift);
  EXPECT_LT((found - x).norm(), 1e-7);
}

}  // namespace
}  // namespace prospect::linear_graph_test
