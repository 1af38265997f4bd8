// SPDX-License-Identifier: Apache-2.0
#include "perception/places/view_loops.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "perception/odometry/se3.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr int kAFew = 3;
/// Of what is not known [m], [rad].
constexpr double kLoose = 10.0, kLooseTurn = std::numbers::pi;

double angle(const Isometry3d& T) { return Eigen::AngleAxisd(T.linear()).angle(); }

/// One that the graph takes, whatever the odometry claims: loose where its claim is none.
Matrix6d information_of(const Matrix6d& covariance) {
  constexpr double kLeast = 1e-5;  // [m], [rad]
  const Matrix6d symmetric =
      0.5 * (covariance + covariance.transpose()) + kLeast * kLeast * Matrix6d::Identity();
  Matrix6d information = symmetric.inverse();
  information = 0.5 * (information + information.transpose()).eval();
  if (is_information(information)) return information;
  Eigen::Matrix<double, 6, 1> loose;
  loose << Eigen::Vector3d::Constant(kLoose), Eigen::Vector3d::Constant(kLooseTurn);
  return loose.cwiseAbs2().cwiseInverse().asDiagonal();
}

PoseGraphOptions judging(const ViewLoopsOptions& options) {
  PoseGraphOptions graph;
  graph.judge.odds /= options.odds;
  return graph;
}

}  // namespace

ViewLoops::ViewLoops(const StereoCamera& camera, const ViewLoopsOptions& options)
    : camera_(camera), options_(options), graph_(judging(options)) {}

const Isometry3d& ViewLoops::measured(int view) const {
  return views_[static_cast<std::size_t>(view)].T_WC;
}

Isometry3d ViewLoops::pose(int view) const { return graph_.pose(view).value_or(measured(view)); }

std::size_t ViewLoops::used() const {
  return static_cast<std::size_t>(
      std::count(graph_.loops().begin(), graph_.loops().end(), LoopState::kUsed));
}

Isometry3d ViewLoops::corrected(const Isometry3d& T_WC) const {
  if (views_.empty()) return T_WC;
  const int newest = views() - 1;
  return pose(newest) * measured(newest).inverse() * T_WC;
}

std::vector<ViewLoops::Candidate> ViewLoops::candidates(const StereoView& view) const {
  std::vector<Candidate> result;
  const int newest = views() - 1;            // the view itself
  const int end = newest - options_.newest;  // of those that count
  if (end <= 0) return result;
  const auto is_new = [&](int k) {
    return std::none_of(result.begin(), result.end(), [&](const Candidate& c) {
      return std::abs(c.view - k) < options_.newest / 2;
    });
  };
  std::vector<int> order;
  const std::vector<int> votes = index_.votes(view);
  for (int k = 0; k < end; ++k) {
    if (votes[static_cast<std::size_t>(k)] >= options_.least_votes) order.push_back(k);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return votes[static_cast<std::size_t>(a)] > votes[static_cast<std::size_t>(b)];
  });
  for (const int k : order) {
    if (static_cast<int>(result.size()) == options_.by_looks) break;
    if (is_new(k)) result.push_back({k, true});
  }
  std::vector<std::pair<double, int>> near;
  const Isometry3d here = pose(newest);
  for (int k = 0; k < end; ++k) {
    const Isometry3d apart = pose(k).inverse() * here;
    if (apart.translation().norm() > options_.reach || angle(apart) > options_.bend) continue;
    near.emplace_back(apart.translation().norm() / options_.reach + angle(apart) / options_.bend,
                      k);
  }
  std::sort(near.begin(), near.end());
  int placed = 0;
  for (const auto& [apart, k] : near) {
    if (placed == options_.by_place) break;
    if (!is_new(k)) continue;
    result.push_back({k, false});
    ++placed;
  }
  return result;
}

bool ViewLoops::is_worth_solving() const {
  if (kAFew * waiting_ >= static_cast<int>(loops_.size())) return true;
  for (std::size_t n = loops_.size() - static_cast<std::size_t>(waiting_); n < loops_.size(); ++n) {
    const Loop& loop = loops_[n];
    const Isometry3d off =
        loop.alignment.measured.T.inverse() * pose(loop.older).inverse() * pose(loop.newer);
    if (off.translation().norm() > options_.most_off || angle(off) > options_.most_turned_off)
      return true;
  }
  return false;
}

void ViewLoops::settle() {
  if (waiting_ == 0) return;
  graph_.optimise();
  waiting_ = 0;
}

void ViewLoops::keyframe(const OdometryFrame& frame, const ImageView& left,
                         const ImageView& right) {
  prior_.disparity_offset = frame.disparity_offset;
  prior_.disparity_offset_sigma = frame.disparity_offset_sigma;
  const bool measured = !frame.covariance_since_keyframe.isZero(0.0) && !frame.restarted;
  Matrix6d since_last = measured ? frame.covariance_since_keyframe : frame.covariance;
  // Meanwhile it may have turned anywhere, whatever it did before it was lost.
  if (frame.restarted) since_last.diagonal().tail<3>().array() += kLooseTurn * kLooseTurn;
  keyframe(frame.T_WC, since_last, left, right);
}

void ViewLoops::keyframe(const Isometry3d& T_WC, const Matrix6d& since_last, const ImageView& left,
                         const ImageView& right) {
  const bool first = views_.empty();
  const Matrix6d carry = adjoint(T_WC.inverse() * T_WK_);
  since_view_ = carry * since_view_ * carry.transpose() + since_last;
  T_WK_ = T_WC;
  if (!first) {
    const Isometry3d moved = views_.back().T_WC.inverse() * T_WC;
    if (moved.translation().norm() < options_.spacing && angle(moved) < options_.turn) return;
  }
  StereoView view = stereo_view(camera_, left, right, options_.view);
  const int id = views();
  if (first) {
    (void)graph_.begin(id, T_WC);
  } else {
    const RelativePose step{views_.back().T_WC.inverse() * T_WC, information_of(since_view_)};
    if (graph_.add_keyframe(id, id - 1, step) != GraphInput::kTaken) return;
  }
  since_view_.setZero();
  views_.push_back({std::move(view), T_WC});
  const StereoView& here = views_.back().view;
  int found = 0;
  const std::vector<Candidate> all = candidates(here);
  for (const Candidate& c : all) {
    if (found == options_.enough) break;
    ViewPrior prior = prior_;
    prior.b_in_a = pose(c.view).inverse() * pose(id);
    const auto alignment = align_views(camera_, views_[static_cast<std::size_t>(c.view)].view, here,
                                       prior, options_.alignment);
    if (!alignment || graph_.add_loop(c.view, id, alignment->measured) != GraphInput::kTaken)
      continue;
    loops_.push_back({c.view, id, *alignment, c.by_looks});
    ++found;
  }
  index_.add(here);
  waiting_ += found;
  if (found > 0 && is_worth_solving()) settle();
}

}  // namespace prospect
