// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "adapters/robots/dds/dds_node.h"

namespace prospect {

/// The frames of a robot behind topics of ROS 2, as its topics of transforms tell them. Of what
/// moves the newest 5 s are kept.
///
/// Declares its topics on the node: make it before DdsNode::start(). Transforms that are none
/// are left out, and with more than 10 000 frames faults of their topic. Thread-safety: any thread.
class DdsTransforms {
 public:
  explicit DdsTransforms(DdsNode& node, const std::string& tf = "/tf",
                         const std::string& tf_static = "/tf_static");
  ~DdsTransforms();

  /// Coordinates of `from` to those of `to` at `stamp` [s] of the robot's clock. What moves is
  /// taken as it was nearest to that time, at most 0.2 s off. None: it is not known.
  std::optional<Eigen::Isometry3d> find(const std::string& to, const std::string& from,
                                        double stamp) const;
  /// The newest.
  std::optional<Eigen::Isometry3d> newest(const std::string& to, const std::string& from) const;

  /// Calls `told` with each newer pose of `from` in `to`, at the newest stamp [s] that all between
  /// them is known at, on the node's thread. Before DdsNode::start().
  void follow(const std::string& to, const std::string& from,
              std::function<void(double stamp, const Eigen::Isometry3d& T)> told);

  /// From now on `from` must stay where it is in `to`.
  void hold(const std::string& to, const std::string& from);
  /// Which of those has moved at `now` [s] of any clock that goes on, by more than 1 cm or 0.01 rad
  /// for half a second, one line; empty: none.
  std::string moved(double now) const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;  // shared with the handlers
};

}  // namespace prospect
