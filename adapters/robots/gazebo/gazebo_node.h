// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace prospect {

/// Where Gazebo's master is.
struct GazeboAddress {
  std::string host = "127.0.0.1";
  int port = 11345;
  double timeout = 5.0;                             ///< [s] to wait for its greeting
  std::size_t frame_limit = std::size_t{64} << 20;  ///< [bytes] of a message
};

/// What somebody publishes.
struct GazeboTopic {
  std::string name;  ///< "/gazebo/WORLD/robot/vel_cmd"
  std::string type;  ///< "gazebo.msgs.Pose"
};

/// A participant of Gazebo's transport (version 11), which links nothing of Gazebo: a connection to
/// the master, one to the publisher of each topic subscribed to, and one from each subscriber to
/// what is published here, through a port of its own. All of it happens in spin().
///
/// A handler is called with the bytes of a message, within spin(), and may throw: that is a fault,
/// and nothing else happens. A message that cannot be read, a connection that closes, and a
/// publisher who is gone are faults, too.
///
/// Thread-safety: one thread at a time. No thread is started.
class GazeboNode {
 public:
  using Handler = std::function<void(std::string_view message)>;

  /// Connects and waits for the master's greeting. Throws InputError: nobody answers there, or no
  /// master of Gazebo; NotBuiltIn without protobuf.
  explicit GazeboNode(const GazeboAddress& address);
  ~GazeboNode();
  GazeboNode(const GazeboNode&) = delete;
  GazeboNode& operator=(const GazeboNode&) = delete;

  /// Published, as far as the master has told.
  const std::vector<GazeboTopic>& topics() const;
  /// The name of the world that is published; empty: none.
  std::string world() const;

  void subscribe(const std::string& topic, const std::string& type, Handler handler);
  /// Publishers that a subscription has connected to.
  int publishers(const std::string& topic) const;

  void advertise(const std::string& topic, const std::string& type);
  int subscribers(const std::string& topic) const;
  /// To those who are connected.
  void publish(const std::string& topic, std::string_view message);

  /// Works off what comes, for at most so many seconds, or until descriptor `also` (-1: none) can
  /// be read.
  void spin(double seconds, int also = -1);

  /// The link to the master, and to all publishers that were found, stands.
  bool connected() const;
  /// What is or went wrong, the newest of each kind; empty: nothing.
  const std::vector<std::string>& faults() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
