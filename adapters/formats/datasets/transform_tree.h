// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>

#include "adapters/formats/datasets/trajectory.h"

namespace prospect {

/// "/base_link" is "base_link".
std::string without_slash(const std::string& frame);

/// Frames and where they are in each other over time, as ROS's tf: a forest, each frame with at
/// most one parent. Names may begin with a slash, which does not count.
///
/// A transform that moves is known at stamps, and between two of them that are at most `max_gap`
/// apart (linearly, and along the geodesic); never before the first and after the last. Each link
/// of a chain is interpolated by itself.
/// Thread-safety: concurrent reads are safe.
class TransformTree {
 public:
  explicit TransformTree(double max_gap = 1.0) : max_gap_(max_gap) {}  ///< [s]

  /// T maps coordinates of `child` to those of `parent`, at `stamp` [s]. False, and nothing is
  /// added, if `child` has another parent already, is `parent`, or is above it.
  bool add(const std::string& parent, const std::string& child, double stamp,
           const Eigen::Isometry3d& T);
  /// The same at all times; the newest of several counts, also against add().
  bool add_static(const std::string& parent, const std::string& child, const Eigen::Isometry3d& T);

  /// Coordinates of `from` to those of `to` at `stamp`; none if they are not connected, or a
  /// transform between them is not known at that time. A frame to itself is the identity.
  std::optional<Eigen::Isometry3d> find(const std::string& to, const std::string& from,
                                        double stamp) const;
  /// The same where transforms that move are held, for what is told while it happens: of each the
  /// one nearest in time, at most `reach` [s] off.
  std::optional<Eigen::Isometry3d> nearest(const std::string& to, const std::string& from,
                                           double stamp, double reach) const;
  /// The newest stamp that find() knows them at [s]: of the transforms that move between them, the
  /// one that is behind. None: they are not connected, or none moves.
  std::optional<double> newest_stamp(const std::string& to, const std::string& from) const;
  /// Drops what moves and is older than `stamp` [s], but for the newest of each.
  void forget_before(double stamp);
  /// Whether they hang together, at whatever time.
  bool connected(const std::string& to, const std::string& from) const;
  /// Whether they hang together by a transform that is not static.
  bool moves(const std::string& to, const std::string& from) const;
  /// The frame above all others of `frame`'s tree; itself if it has no parent.
  std::string root(const std::string& frame) const;
  /// The parent; empty if it has none.
  std::string parent(const std::string& frame) const;

 private:
  struct Link {
    std::string parent;
    std::optional<Eigen::Isometry3d> fixed;
    Trajectory poses;  // by increasing stamps
  };
  Link* link_to(const std::string& parent, const std::string& child);
  bool is_above(const std::string& frame, std::string other) const;
  std::string meeting(const std::string& to, const std::string& from) const;
  bool moves_below(const std::string& above, std::string frame) const;
  template <typename At>
  std::optional<Eigen::Isometry3d> up_to(const std::string& above, std::string frame,
                                         const At& at) const;
  template <typename At>
  std::optional<Eigen::Isometry3d> between(const std::string& to, const std::string& from,
                                           const At& at) const;

  double max_gap_;
  std::map<std::string, Link> links_;  // by child
};

}  // namespace prospect
