// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/message_definition.h"

namespace prospect {

/// Where the other nodes are, and how DDS reaches them.
struct DdsAddress {
  int domain = 0;                 ///< as ROS_DOMAIN_ID, 0 to 232
  std::string node = "prospect";  ///< name in ROS 2
  bool loopback = false;          ///< this machine alone, without multicast
  std::string configuration{};    ///< file of CycloneDDS's XML; empty: dds_configuration()
  std::string its_namespace{};    ///< of the node: "" or "/robot"
  std::string uri{};              ///< as CYCLONEDDS_URI: above dds_configuration(); empty: nothing
};

/// How much is kept and sent again, as profiles of ROS 2. A reader that is less strict than the
/// writer still hears it.
struct DdsQos {
  bool reliable = true;
  bool transient_local = false;  ///< the newest also to who comes later
  int depth = 10;                ///< kept: the newest so many
  /// [s] without a sign of life after which a writer counts as gone, as it promises (its liveliness
  /// lease, automatic); a reader hears none that promises more. 0: the default of DDS, never.
  double lease = 0.0;
};
inline constexpr DdsQos kSensorQos{false, false, 5};
inline constexpr DdsQos kCommandQos{true, false, 1};
inline constexpr DdsQos kReliableQos{true, false, 10};
inline constexpr DdsQos kLatchedQos{true, true, 1};
inline constexpr DdsQos kTransformQos{true, false, 100};
inline constexpr DdsQos kStaticTransformQos{true, true, 100};

/// The configuration of CycloneDDS that is used without a file: large messages and fragments, a
/// receive buffer for images, and with `loopback` nothing but this machine.
std::string dds_configuration(bool loopback);

/// A node of ROS 2 on DDS, without ROS 2: topics and types by its names, with type hashes, and
/// announced in ros_discovery_info, so that `ros2 node list` knows it.
///
/// Declare all topics, then start() a thread of its own that calls the handlers, one at a time. A
/// message whose handler throws (InputError: what came is no such message) is left out; several
/// are a fault of its topic, until good ones come (sample_judge.h).
///
/// The first node of a domain in a process gives the domain its configuration and must be the last
/// one to end. Thread-safety: after start() any thread. Errors: the constructor and declarations
/// throw InputError, one line, or NotBuiltIn; publish() never throws.
class DdsNode {
 public:
  /// `name`: the topic, for errors of reading.
  using Handler = std::function<void(std::string_view cdr, const std::string& name)>;
  /// `publisher`: tells those of a topic apart.
  using PublisherHandler =
      std::function<void(std::string_view cdr, const std::string& name, std::uint64_t publisher)>;

  /// What a name stands for: a topic, or one half of a service (dds_service.h).
  enum class Role { kTopic, kRequests, kReplies };

  explicit DdsNode(const DdsAddress& address);
  ~DdsNode();  ///< waits until no handler runs
  DdsNode(const DdsNode&) = delete;
  DdsNode& operator=(const DdsNode&) = delete;

  void subscribe(const std::string& topic, const std::vector<ros::MessageDefinition>& definition,
                 const DdsQos& qos, PublisherHandler handler, Role role = Role::kTopic);
  void subscribe(const std::string& topic, const std::vector<ros::MessageDefinition>& definition,
                 const DdsQos& qos, Handler handler);
  /// handle: takes the message, and the publisher if it wants to.
  template <ros::Message T, typename Handle>
  void subscribe(const std::string& topic, const DdsQos& qos, Handle handle) {
    subscribe(topic, ros::definition_of<T>(), qos,
              [handle = std::move(handle)](std::string_view cdr, const std::string& name,
                                           std::uint64_t publisher) {
                if constexpr (std::is_invocable_v<const Handle&, T, std::uint64_t>) {
                  handle(ros::from_cdr<T>(cdr, name), publisher);
                } else {
                  handle(ros::from_cdr<T>(cdr, name));
                }
              });
  }

  /// The number of the topic, for publish().
  int advertise(const std::string& topic, const std::vector<ros::MessageDefinition>& definition,
                const DdsQos& qos, Role role = Role::kTopic);
  template <ros::Message T>
  int advertise(const std::string& topic, const DdsQos& qos) {
    return advertise(topic, ros::definition_of<T>(), qos);
  }
  /// Who publishes on a topic of others is asked, too (publisher_names()).
  void watch(const std::string& topic);
  void start();
  void stop();  ///< no handler runs after it

  /// Hands it to DDS, and waits for nobody. False: DDS did not take it. `topic` < 0: none.
  bool publish(int topic, const std::string& cdr) noexcept;
  template <ros::Message T>
  bool publish(int topic, const T& message, std::size_t extra = 0) {
    return topic >= 0 && publish(topic, ros::to_cdr(message, extra));
  }
  /// To who published a request: once he listens to the topic, which he may do a moment later than
  /// he asks; if he does not within a second, to nobody.
  void answer(int topic, std::uint64_t publisher, std::string cdr);

  /// Others' publishers that a subscription hears, subscribers that hear us.
  int publishers(const std::string& topic) const;
  /// Those publishers, as handlers are told them; none, if one of them has broken its promise to
  /// give a sign of life (DdsQos::lease): which one is not told.
  std::vector<std::uint64_t> live_publishers(const std::string& topic) const;
  int subscribers(const std::string& topic) const;
  /// Names of all who publish on a topic, on one that is heard those of its type, this node first
  /// if it does: "/prospect (this program)", "/teleop", "the process rviz2 (123 on robot)".
  std::vector<std::string> publisher_names(const std::string& topic) const;
  /// What is wrong with a topic, one line: messages that are none, or that nobody is connected,
  /// and who is there has another type or QoS. Empty: nothing.
  std::string fault(const std::string& topic) const;
  /// Of all topics; also who is not connected beside one that is.
  std::vector<std::string> faults() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
