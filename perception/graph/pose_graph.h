// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "perception/graph/graph_solver.h"
#include "perception/graph/linear_graph.h"
#include "perception/graph/loop_judge.h"
#include "perception/graph/odometry_tree.h"
#include "perception/odometry/relative_pose.h"

namespace prospect {

/// What became of something that was to enter a graph. Only what is taken changes it.
enum class GraphInput : std::uint8_t {
  kTaken,
  kKnownKeyframe,     ///< a keyframe with this number is there
  kUnknownKeyframe,   ///< no keyframe with this number is there
  kSameKeyframe,      ///< a loop from a keyframe to itself
  kNotAPose,          ///< no rotation and translation (is_pose()), or farther than kFarthest
  kNotAnInformation,  ///< is_information()
};
std::string_view reason(GraphInput input);

struct PoseGraphOptions {
  LoopJudgeOptions judge;
  bool trust_loops = false;  ///< all loops are used, none is judged: to measure against
};

/// Keyframes that odometry connects, and loops between them that may be wrong:
///   min over T_k, beta   sum over odometry |r|^2 + sum over loops used |r|^2
///                        + |beta|^2 / drift_sigma^2,
/// errors r by GraphEdge, the common drift beta of odometry by GraphEstimate; which loops are used
/// by LoopJudge. Gauge: the first keyframe stays where it was put.
///
/// Loops are judged between the keyframes that they connect (reduced_tree()), then all keyframes
/// are solved for. Loops that come later are judged in the graph that is there; from odometry
/// again when those that are not used have become half as many again, so that one that was used
/// early keeps none out for good.
///
/// Same calls, same budgets in iterations: same bits. Nothing throws but out of memory.
/// Thread-safety: one caller at a time.
class PoseGraph {
 public:
  using Matrix6d = Eigen::Matrix<double, 6, 6>;

  explicit PoseGraph(const PoseGraphOptions& options = {}) : options_(options) {}

  /// The first keyframe, at T_W.
  [[nodiscard]] GraphInput begin(int id, const Eigen::Isometry3d& T_W);
  /// A keyframe that odometry measured from one that is there.
  [[nodiscard]] GraphInput add_keyframe(int id, int from, const RelativePose& measured);
  /// A measurement of one keyframe in another, both there.
  [[nodiscard]] GraphInput add_loop(int from, int to, const RelativePose& measured);

  /// Judges and solves within a budget, in pieces: the next call goes on where this one stopped, a
  /// little at least. Poses and states change when the judging is done; until then those of before
  /// hold. Returns whether all is done.
  bool optimise(GraphBudget budget = {});

  std::size_t keyframes() const { return tree_.size(); }
  /// T_W of a keyframe; of one that is not there nothing.
  std::optional<Eigen::Isometry3d> pose(int id) const;
  /// In the order in which they came.
  const std::vector<LoopState>& loops() const { return now_.states; }
  /// By what all deviations are smaller than told (LoopJudge).
  double scale() const { return now_.scale == 0.0 ? 1.0 : now_.scale; }
  /// Covariance of T_from^-1 T_to, of n = (t, omega) in `to`, with scale()^2; from the first
  /// keyframe: of its place in W. Nothing of keyframes that are not there. The first call after a
  /// change decomposes the graph, each takes about as long as an iteration.
  std::optional<Matrix6d> covariance(int from, int to) const;

 private:
  struct Loop {
    int from, to;
    RelativePose measured;
  };
  struct Judgement {
    std::vector<LoopState> states;
    double scale = 0.0;  ///< 0: not known yet
    GraphEstimate estimate;
  };
  struct Working {
    Judgement judgement;
    ReducedTree tree;
    std::unique_ptr<LoopJudge> judge;  ///< null: to be made
    bool from_odometry = false;
  };
  struct Linear {
    std::vector<GraphEdge> edges;
    std::optional<LinearGraph> graph;
  };

  std::optional<int> index(int id) const;
  std::optional<GraphInput> misfit(const RelativePose& measured) const;
  void changed(bool planar);
  void keep_what_is_judged();
  bool judge(GraphBudget& budget);
  std::size_t loops_not_used() const;
  Working work() const;
  void begin_judging();
  std::vector<GraphEdge> edges_in_use() const;

  PoseGraphOptions options_;
  std::unordered_map<int, int> index_;
  std::vector<KeyframeStep> tree_;
  std::vector<Loop> loops_;
  std::vector<Eigen::Isometry3d> by_odometry_;
  bool planar_ = true;
  Judgement now_;
  std::optional<Working> working_;
  std::size_t new_loops_ = 0;  ///< that no judging has begun with
  std::size_t not_used_ = 0;   ///< when they were judged from odometry the last time
  bool judged_ = true, solved_ = true;
  mutable std::unique_ptr<Linear> linear_;
};

}  // namespace prospect
