// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "perception/graph/graph_solver.h"
#include "perception/graph/linear_graph.h"
#include "perception/graph/loop_evidence.h"

namespace prospect {

struct LoopJudgeOptions {
  double drift_sigma = 0.1;  ///< of beta (GraphEstimate): a tenth of a step's deviation, each step
  double nu = 3.0;           ///< degrees of freedom of an innovation (LoopTest)
  /// A loop is used if it is right at these odds, where every second loop is.
  double odds = 50.0;
  double sure = 0.1;       ///< wrong loops, in all, that would fit as well as one that is sure
  double lone = 0.3;       ///< the same, of one that is used for want of a surer one
  double limit = 12.0;     ///< chi^2 a dimension beyond which a used loop is given up
  double strain = 100.0;   ///< chi^2 of any edge beyond which loops that came in together are not
                           ///< taken together
  int samples = 200;       ///< of the graph's distribution
  int together = 60;       ///< loops, at most, that are judged with their joint covariance
  std::uint64_t seed = 1;  ///< of the samples
};

enum class LoopState : std::uint8_t {
  kOpen,    ///< not used, as nothing tells yet that it is right
  kUsed,    ///< part of the graph
  kGivenUp  ///< was used, and spoke against the others
};

/// Judges loops in the graph that they close. None is softened by a robust loss: a loop is used as
/// measured, or not at all. From odometry alone, which is trusted within its noise and drift:
///
/// 1. Solve the graph with the loops that are used.
/// 2. Of each other one compare the innovation with its covariance in this graph (LoopTest), from
///    samples of the graph's distribution.
/// 3. Loops that are sure are all used, and the graph is solved again: it is stiffer now, so others
///    become sure. If an edge is then strained, two groups of them contradict each other: they are
///    taken back and go the way of 4.
/// 4. If there is none, those that are likely are judged with their joint covariance: the one is
///    used that most others agree with, once it is in, and after it those that it makes sure.
/// 5. If none is likely, every used loop is held against the graph without it. Those that speak
///    against it are given up, the worst first, for good.
/// It ends when nothing changes.
///
/// *Right at odds*: the prior odds of a loop are those of right loops in this graph
/// (share_of_right()), between 1 and 20: where nearly all are right, little evidence is enough.
/// *Sure*: fewer than `sure` wrong loops, of all that there are, would fit as well by chance.
///
/// *Scale*: information is often too small, by a factor that all edges have in common. Before any
/// loop is used, the largest s = 1, 1/2, ... 1/256 is chosen for which no smaller one finds more
/// right loops (by a fifth and two, and beyond those that chance finds).
///
/// The result does not depend on the order of the loops but for rounding, and is the same for the
/// same input. Thread-safety: as a value.
class LoopJudge {
 public:
  /// `odometry` must connect all poses of `start`, which has the first one where it belongs. Loops
  /// with a state are judged further from there, with the scale found then; 0: to be found.
  /// `spread`: W of all that a loop could connect (pose_spread()).
  LoopJudge(std::vector<GraphEdge> odometry, std::vector<GraphEdge> loops,
            std::vector<LoopState> states, double scale, GraphEstimate start,
            const Eigen::Matrix<double, 6, 6>& spread, const LoopJudgeOptions& options);

  /// Goes on until all is judged or the budget is spent; a little in any case. Returns whether all
  /// is judged.
  bool run(GraphBudget& budget);

  /// Those of the last graph that was solved.
  std::vector<LoopState> states() const;
  const GraphEstimate& estimate() const { return together_.empty() ? estimate_ : before_; }
  double scale() const { return scale_; }

 private:
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  /// A loop that is not used, and how it fits.
  struct Candidate {
    std::size_t loop;
    LinearGraph::Change change;
    LoopEvidence evidence;
  };
  /// What counts for all candidates at a time.
  struct Standard {
    double accept = 0.0;  ///< least score of a likely loop
    double wrong = 0.0;   ///< log of the number of wrong candidates
  };

  std::vector<const GraphEdge*> edges_in_use() const;
  double worst_strain() const;
  bool take_back_if_strained();
  bool change_loops();
  std::vector<Candidate> candidates(const LinearGraph& graph, Standard& standard);
  void find_scale(const std::vector<LoopTest>& tests);
  bool is_sure(const LoopEvidence& evidence, const Standard& standard) const;
  bool use_agreeing(const LinearGraph& graph, const std::vector<Candidate>& open,
                    const Standard& standard);
  bool give_up_contradicting(const LinearGraph& graph);
  std::vector<Vector6d> errors_of_used(const LinearGraph& graph) const;
  std::vector<double> strains_of_used(const LinearGraph& graph,
                                      const std::vector<Vector6d>& errors) const;

  LoopJudgeOptions options_;
  std::vector<GraphEdge> odometry_, loops_;
  std::vector<Matrix6d> noise_;  ///< covariances of the loops
  std::vector<LoopState> states_;
  double scale_;
  GraphEstimate estimate_;
  Matrix6d spread_;
  /// Loops that came in together, until the graph is solved; the estimate without them.
  std::vector<std::size_t> together_;
  GraphEstimate before_;
  bool careful_ = false;  ///< none comes in together with others
};

}  // namespace prospect
