// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/transform_tree.h"

#include <algorithm>
#include <cmath>

namespace prospect {

std::string without_slash(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

TransformTree::Link* TransformTree::link_to(const std::string& parent, const std::string& child) {
  const std::string above = without_slash(parent), below = without_slash(child);
  const auto known = links_.find(below);
  if (known != links_.end()) return known->second.parent == above ? &known->second : nullptr;
  if (is_above(below, above)) return nullptr;
  Link& link = links_[below];
  link.parent = above;
  return &link;
}

bool TransformTree::add(const std::string& parent, const std::string& child, double stamp,
                        const Eigen::Isometry3d& T) {
  Link* link = link_to(parent, child);
  if (link == nullptr) return false;
  const auto at =
      std::lower_bound(link->poses.begin(), link->poses.end(), stamp,
                       [](const TimedPose& pose, double time) { return pose.stamp < time; });
  if (at != link->poses.end() && at->stamp == stamp) return true;  // said twice
  link->poses.insert(at, {stamp, T});
  return true;
}

bool TransformTree::add_static(const std::string& parent, const std::string& child,
                               const Eigen::Isometry3d& T) {
  Link* link = link_to(parent, child);
  if (link == nullptr) return false;
  link->fixed = T;
  return true;
}

bool TransformTree::is_above(const std::string& frame, std::string other) const {
  while (true) {
    if (other == frame) return true;
    const auto link = links_.find(other);
    if (link == links_.end()) return false;
    other = link->second.parent;
  }
}

/// The lowest frame above both; empty if there is none.
std::string TransformTree::meeting(const std::string& to, const std::string& from) const {
  std::string above = without_slash(to);
  while (!is_above(above, without_slash(from))) {
    const auto link = links_.find(above);
    if (link == links_.end()) return {};
    above = link->second.parent;
  }
  return above;
}

bool TransformTree::moves_below(const std::string& above, std::string frame) const {
  for (; frame != above; frame = links_.at(frame).parent) {
    if (!links_.at(frame).fixed) return true;
  }
  return false;
}

/// at(poses): of a link that moves.
template <typename At>
std::optional<Eigen::Isometry3d> TransformTree::up_to(const std::string& above, std::string frame,
                                                      const At& at) const {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  while (frame != above) {
    const Link& link = links_.at(frame);
    const auto step = link.fixed ? link.fixed : at(link.poses);
    if (!step) return std::nullopt;
    T = *step * T;
    frame = link.parent;
  }
  return T;
}

template <typename At>
std::optional<Eigen::Isometry3d> TransformTree::between(const std::string& to,
                                                        const std::string& from,
                                                        const At& at) const {
  const std::string above = meeting(to, from);
  if (above.empty()) return std::nullopt;
  const auto T_from = up_to(above, without_slash(from), at);
  const auto T_to = up_to(above, without_slash(to), at);
  if (!T_from || !T_to) return std::nullopt;
  return T_to->inverse() * *T_from;
}

std::optional<Eigen::Isometry3d> TransformTree::find(const std::string& to, const std::string& from,
                                                     double stamp) const {
  return between(to, from,
                 [&](const Trajectory& poses) { return pose_at(poses, stamp, max_gap_); });
}

std::optional<Eigen::Isometry3d> TransformTree::nearest(const std::string& to,
                                                        const std::string& from, double stamp,
                                                        double reach) const {
  return between(to, from, [&](const Trajectory& poses) -> std::optional<Eigen::Isometry3d> {
    const auto off = [&](const TimedPose& pose) { return std::abs(pose.stamp - stamp); };
    const auto best =
        std::min_element(poses.begin(), poses.end(),
                         [&](const TimedPose& a, const TimedPose& b) { return off(a) < off(b); });
    if (best == poses.end() || off(*best) > reach) return std::nullopt;
    return best->T;
  });
}

std::optional<double> TransformTree::newest_stamp(const std::string& to,
                                                  const std::string& from) const {
  std::optional<double> newest;
  const bool known = between(to, from, [&](const Trajectory& poses) {
                       if (poses.empty()) return std::optional<Eigen::Isometry3d>();
                       newest = std::min(newest.value_or(poses.back().stamp), poses.back().stamp);
                       return std::optional(poses.back().T);
                     }).has_value();
  return known ? newest : std::nullopt;
}

void TransformTree::forget_before(double stamp) {
  for (auto& [child, link] : links_) {
    if (link.poses.empty()) continue;
    const auto first = std::find_if(link.poses.begin(), link.poses.end() - 1,
                                    [&](const TimedPose& pose) { return pose.stamp >= stamp; });
    link.poses.erase(link.poses.begin(), first);
  }
}

bool TransformTree::connected(const std::string& to, const std::string& from) const {
  return !meeting(to, from).empty();
}

bool TransformTree::moves(const std::string& to, const std::string& from) const {
  const std::string above = meeting(to, from);
  return !above.empty() &&
         (moves_below(above, without_slash(to)) || moves_below(above, without_slash(from)));
}

std::string TransformTree::root(const std::string& frame) const {
  std::string top = without_slash(frame);
  for (std::string next = parent(top); !next.empty(); next = parent(top)) top = next;
  return top;
}

std::string TransformTree::parent(const std::string& frame) const {
  const auto link = links_.find(without_slash(frame));
  return link == links_.end() ? std::string() : link->second.parent;
}

}  // namespace prospect
