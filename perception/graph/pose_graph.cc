// SPDX-License-Identifier: Apache-2.0
#include "perception/graph/pose_graph.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/types.h"
#include "perception/mapping/pose_check.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;

bool is_planar(const RelativePose& measured) {
  const Eigen::Matrix3d R = measured.T.linear();
  if (measured.T.translation().z() != 0.0 || R(2, 2) != 1.0) return false;
  for (const int inside : {0, 1, 5}) {
    for (const int outside : {2, 3, 4}) {
      if (measured.information(inside, outside) != 0.0) return false;
    }
  }
  return true;
}

bool is_near_pose(const Isometry3d& T) {
  return is_pose(T) && T.translation().cwiseAbs().maxCoeff() <= kFarthest;
}

/// With a rotation to rounding.
RelativePose orthonormal(RelativePose measured) {
  measured.T.linear() = Eigen::Quaterniond(measured.T.linear()).normalized().toRotationMatrix();
  return measured;
}

std::vector<const GraphEdge*> pointers_to(const std::vector<GraphEdge>& edges) {
  std::vector<const GraphEdge*> pointers;
  for (const GraphEdge& edge : edges) pointers.push_back(&edge);
  return pointers;
}

}  // namespace

std::string_view reason(GraphInput input) {
  switch (input) {
    case GraphInput::kTaken:
      return "taken";
    case GraphInput::kKnownKeyframe:
      return "a keyframe with this number is there already";
    case GraphInput::kUnknownKeyframe:
      return "no keyframe with this number is there";
    case GraphInput::kSameKeyframe:
      return "a loop from a keyframe to itself";
    case GraphInput::kNotAPose:
      return "not a pose; expected a rotation and a translation of at most 1e6 m";
    case GraphInput::kNotAnInformation:
      return "not an information matrix; expected one that is finite, symmetric and positive "
             "definite, with standard deviations between 1e-6 and 1e6";
  }
  return "";
}

GraphInput PoseGraph::begin(int id, const Isometry3d& T_W) {
  if (!tree_.empty()) return GraphInput::kKnownKeyframe;
  if (!is_near_pose(T_W)) return GraphInput::kNotAPose;
  index_[id] = 0;
  tree_.emplace_back();
  by_odometry_.push_back(T_W);
  now_.estimate.poses.push_back(T_W);
  now_.estimate.planar = planar_;
  return GraphInput::kTaken;
}

GraphInput PoseGraph::add_keyframe(int id, int from, const RelativePose& measured) {
  const auto parent = index(from);
  if (!parent) return GraphInput::kUnknownKeyframe;
  if (index(id)) return GraphInput::kKnownKeyframe;
  if (const auto wrong = misfit(measured)) return *wrong;
  keep_what_is_judged();
  const RelativePose step = orthonormal(measured);
  index_[id] = static_cast<int>(tree_.size());
  tree_.push_back({*parent, step});
  const auto extend = [&](std::vector<Isometry3d>& poses) {
    poses.push_back(poses[static_cast<std::size_t>(*parent)] * step.T);
  };
  extend(by_odometry_);
  extend(now_.estimate.poses);
  if (working_) extend(working_->judgement.estimate.poses);
  changed(is_planar(measured));
  return GraphInput::kTaken;
}

GraphInput PoseGraph::add_loop(int from, int to, const RelativePose& measured) {
  const auto a = index(from), b = index(to);
  if (!a || !b) return GraphInput::kUnknownKeyframe;
  if (from == to) return GraphInput::kSameKeyframe;
  if (const auto wrong = misfit(measured)) return *wrong;
  keep_what_is_judged();
  loops_.push_back({*a, *b, orthonormal(measured)});
  now_.states.push_back(options_.trust_loops ? LoopState::kUsed : LoopState::kOpen);
  if (working_) working_->judgement.states.push_back(LoopState::kOpen);
  judged_ = options_.trust_loops;
  ++new_loops_;
  changed(is_planar(measured));
  return GraphInput::kTaken;
}

std::optional<int> PoseGraph::index(int id) const {
  const auto found = index_.find(id);
  if (found == index_.end()) return std::nullopt;
  return found->second;
}

std::optional<GraphInput> PoseGraph::misfit(const RelativePose& measured) const {
  if (!is_near_pose(measured.T)) return GraphInput::kNotAPose;
  if (!is_information(measured.information)) return GraphInput::kNotAnInformation;
  return std::nullopt;
}

void PoseGraph::changed(bool planar) {
  planar_ = planar_ && planar;
  now_.estimate.planar = planar_;
  if (working_) working_->judgement.estimate.planar = planar_;
  solved_ = false;
  linear_.reset();
}

// What is being judged goes on with what is added, from the last graph that was solved.
void PoseGraph::keep_what_is_judged() {
  if (!working_ || !working_->judge) return;
  Judgement& judgement = working_->judgement;
  const LoopJudge& judge = *working_->judge;
  judgement.states = judge.states();
  judgement.scale = judge.scale();
  judgement.estimate.beta = judge.estimate().beta;
  std::vector<Isometry3d>& poses = judgement.estimate.poses;
  // What lies between kept keyframes moves with the one before it.
  std::vector<Isometry3d> moved;
  for (std::size_t k = 0; k < working_->tree.kept.size(); ++k) {
    moved.push_back(judge.estimate().poses[k] *
                    poses[static_cast<std::size_t>(working_->tree.kept[k])].inverse());
  }
  for (std::size_t k = 0; k < poses.size(); ++k) {
    poses[k] = moved[static_cast<std::size_t>(working_->tree.anchor[k])] * poses[k];
  }
  working_->judge.reset();
}

std::size_t PoseGraph::loops_not_used() const {
  return now_.states.size() - static_cast<std::size_t>(std::count(
                                  now_.states.begin(), now_.states.end(), LoopState::kUsed));
}

PoseGraph::Working PoseGraph::work() const {
  Working working;
  working.from_odometry = 2 * (loops_not_used() - new_loops_) >= 3 * not_used_ + 2;
  working.judgement = now_;
  if (working.from_odometry) {
    working.judgement = {};
    working.judgement.states.assign(loops_.size(), LoopState::kOpen);
    working.judgement.estimate.poses = by_odometry_;
    working.judgement.estimate.planar = planar_;
  }
  return working;
}

void PoseGraph::begin_judging() {
  std::vector<char> keep(tree_.size(), 0);
  for (const Loop& loop : loops_) {
    keep[static_cast<std::size_t>(loop.from)] = keep[static_cast<std::size_t>(loop.to)] = 1;
  }
  working_->tree = reduced_tree(tree_, keep);
  const ReducedTree& tree = working_->tree;
  std::vector<GraphEdge> loops;
  for (const Loop& loop : loops_) {
    loops.push_back(loop_edge(tree.anchor[static_cast<std::size_t>(loop.from)],
                              tree.anchor[static_cast<std::size_t>(loop.to)], loop.measured));
  }
  const Judgement& judgement = working_->judgement;
  GraphEstimate start = judgement.estimate;
  start.poses.clear();
  for (const int k : tree.kept) {
    start.poses.push_back(judgement.estimate.poses[static_cast<std::size_t>(k)]);
  }
  working_->judge = std::make_unique<LoopJudge>(
      tree.edges, std::move(loops), judgement.states, judgement.scale, std::move(start),
      pose_spread(judgement.estimate.poses), options_.judge);
}

bool PoseGraph::judge(GraphBudget& budget) {
  if (!working_) {
    working_ = work();
    new_loops_ = 0;
  }
  if (!working_->judge) begin_judging();
  if (!working_->judge->run(budget)) return false;
  keep_what_is_judged();
  now_ = std::move(working_->judgement);
  if (working_->from_odometry) not_used_ = loops_not_used();
  working_.reset();
  judged_ = true;
  solved_ = false;
  linear_.reset();
  return true;
}

bool PoseGraph::optimise(GraphBudget budget) {
  if (!judged_ && !judge(budget)) return false;
  if (solved_ || tree_.size() < 2) return true;
  const std::vector<GraphEdge> edges = edges_in_use();
  solved_ =
      solve_graph(pointers_to(edges), options_.judge.drift_sigma, 1e-6, budget, now_.estimate);
  linear_.reset();
  return solved_;
}

std::vector<GraphEdge> PoseGraph::edges_in_use() const {
  std::vector<GraphEdge> edges = odometry_edges(tree_);
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    if (now_.states[k] != LoopState::kUsed) continue;
    edges.push_back(loop_edge(loops_[k].from, loops_[k].to, loops_[k].measured));
  }
  return edges;
}

std::optional<Isometry3d> PoseGraph::pose(int id) const {
  const auto k = index(id);
  if (!k) return std::nullopt;
  return now_.estimate.poses[static_cast<std::size_t>(*k)];
}

std::optional<PoseGraph::Matrix6d> PoseGraph::covariance(int from, int to) const {
  const auto a = index(from), b = index(to);
  if (!a || !b) return std::nullopt;
  if (*a == *b) return Matrix6d(Matrix6d::Zero());
  if (!linear_) {
    linear_ = std::make_unique<Linear>();
    linear_->edges = edges_in_use();
    linear_->graph.emplace(pointers_to(linear_->edges), options_.judge.drift_sigma, now_.estimate);
  }
  const LinearGraph& graph = *linear_->graph;
  if (!graph.ok()) return std::nullopt;
  const LinearGraph::Change change = graph.change(*a, *b);
  return Matrix6d(scale() * scale() * graph.covariance(change, graph.response(change)));
}

}  // namespace prospect
