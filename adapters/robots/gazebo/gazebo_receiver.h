// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "adapters/robots/gazebo/gazebo_node.h"
#include "adapters/robots/gazebo/gazebo_options.h"

namespace prospect {

/// A GazeboNode that subscribes, and the thread that works it: handlers are called by that thread.
/// It ends with the object.
///
/// Thread-safety: subscribe() and start() by who makes it, in that order; the rest by any thread.
/// Errors: the constructor throws as check(GazeboOptions), GazeboNode and gazebo_world_name() do.
/// Later nothing throws: see faults().
class GazeboReceiver {
 public:
  explicit GazeboReceiver(const GazeboOptions& options);
  ~GazeboReceiver();
  GazeboReceiver(const GazeboReceiver&) = delete;
  GazeboReceiver& operator=(const GazeboReceiver&) = delete;

  /// topic: below "/gazebo/WORLD/".
  void subscribe(const std::string& topic, const std::string& type, GazeboNode::Handler handler);
  void start();

  /// The world's name.
  const std::string& world() const;
  /// The links to the master and to a publisher of each topic stand.
  bool connected() const;
  /// What is wrong, a sentence each.
  std::vector<std::string> faults() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
