// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace prospect {

/// A publisher or a subscription of another participant, by its names in DDS.
struct DiscoveredEndpoint {
  std::string topic, type;
  std::string participant;  ///< 16 bytes of its GUID
  bool writes = false;
};

/// Who else speaks or listens, as discovery tells. Keys are the 16 bytes of a GUID. Bounded: of
/// each kind the first thousand are remembered. A value; one thread at a time.
class DiscoveredEndpoints {
 public:
  void add(const std::string& key, DiscoveredEndpoint endpoint);
  void remove(const std::string& key) { endpoints_.erase(key); }

  /// What a participant says of itself: its name, or that of its process; empty: nothing.
  void set_participant(const std::string& key, const std::string& name);
  void remove_participant(const std::string& key);
  /// The nodes of ROS 2 that a participant tells of (ros_discovery_info): each endpoint's.
  void set_nodes(const std::string& participant,
                 std::map<std::string, std::string> node_of_endpoint);

  /// Names of those who publish on a topic, with the type unless that is empty: "/teleop", "the
  /// process rviz2 (123 on robot)" or "0110a2c8..." of one that says no name.
  std::vector<std::string> writers(std::string_view topic, std::string_view type) const;
  /// The type of another endpoint of a topic that differs from `type`; empty: none does.
  std::string other_type(std::string_view topic, std::string_view type, bool writes) const;

 private:
  std::string name_of(const std::string& key, const std::string& participant) const;

  std::map<std::string, DiscoveredEndpoint> endpoints_;
  std::map<std::string, std::string> participants_;
  std::map<std::string, std::map<std::string, std::string>> nodes_;  // of endpoints, by participant
};

}  // namespace prospect
