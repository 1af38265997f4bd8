// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <deque>
#include <functional>
#include <list>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "adapters/robots/gazebo/frame_stream.h"
#include "adapters/robots/gazebo/gazebo_options.h"
#include "adapters/robots/gazebo/messages.pb.h"
#include "models/types.h"

namespace prospect::test {

/// Waits until `done`, at most 5 s.
inline bool soon(const std::function<bool()>& done) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (!done()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

/// A master of Gazebo with a world "room" that publishes what it is told to, and a DiffDrivePlugin
/// that listens, over loopback: the same wire, another writer.
class FakeGazebo {
 public:
  /// What it says to a message of somebody else's topic: messages by topic. Called by its thread.
  using Answers = std::vector<std::pair<std::string, std::string>>;
  using Answer = std::function<Answers(const std::string& topic, std::string_view message)>;
  /// What it says when somebody listens to a topic: before, nothing of it reaches anybody.
  using Listened = std::function<Answers(const std::string& topic)>;

  explicit FakeGazebo(Answer answer = {}, Listened listened = {})
      : answer_(std::move(answer)),
        listened_(std::move(listened)),
        master_(listen(master_port_)),
        data_(listen(data_port_)) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  ~FakeGazebo() {
    thread_ = {};
    ::close(master_);
    ::close(data_);
  }
  FakeGazebo(const FakeGazebo&) = delete;
  FakeGazebo& operator=(const FakeGazebo&) = delete;

  GazeboOptions options() const {
    GazeboOptions options;
    options.address.port = master_port_;
    options.dead_man = 0.05;
    options.period = 0.01;
    return options;
  }

  void publish(const std::string& topic, const google::protobuf::Message& message) {
    publish(topic, message.SerializeAsString());
  }
  void publish(const std::string& topic, const std::string& bytes) {
    const std::lock_guard lock(mutex_);
    send(topic, bytes);
  }
  int subscribers(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(std::count_if(links_.begin(), links_.end(), [&](const Link& link) {
      return link.kind == Link::kReader && link.topic == topic;
    }));
  }
  /// Speed and yaw of the quaternion of each velocity that came, since the call before.
  std::vector<std::pair<double, double>> velocities() {
    const std::lock_guard lock(mutex_);
    return std::exchange(velocities_, {});
  }
  /// Closes all connections, as a server that ends.
  void end() {
    const std::lock_guard lock(mutex_);
    links_.clear();
    ended_ = true;
  }

  static google::protobuf::int32 whole(double stamp) {
    return static_cast<google::protobuf::int32>(std::floor(stamp));
  }
  template <typename Message>
  static void stamp(Message& message, double time) {
    message.mutable_time()->set_sec(whole(time));
    message.mutable_time()->set_nsec(
        static_cast<google::protobuf::int32>(std::lround(1e9 * (time - std::floor(time)))));
  }

 private:
  struct Link {
    enum Kind { kClient, kReader, kWriter } kind;
    std::string topic;
    FrameStream stream;
  };

  void send(const std::string& topic, const std::string& bytes) {
    for (Link& link : links_) {
      if (link.kind == Link::kReader && link.topic == topic) link.stream.send(bytes);
    }
  }

  void send_all(const Answers& all) {
    for (const auto& [topic, bytes] : all) send(topic, bytes);
  }

  static int listen(int& port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    ::bind(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address);
    ::listen(descriptor, 8);
    socklen_t size = sizeof address;
    ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size);
    port = ntohs(address.sin_port);
    return descriptor;
  }

  static std::string packet(const std::string& type, const google::protobuf::Message& content) {
    gazebo::msgs::Packet out;
    out.mutable_stamp()->set_sec(1);
    out.mutable_stamp()->set_nsec(0);
    out.set_type(type);
    out.set_serialized_data(content.SerializeAsString());
    return out.SerializeAsString();
  }
  gazebo::msgs::Publish offer(const std::string& topic, const std::string& type) const {
    gazebo::msgs::Publish out;
    out.set_topic(topic);
    out.set_msg_type(type);
    out.set_host("127.0.0.1");
    out.set_port(static_cast<unsigned>(data_port_));
    return out;
  }

  void accept(int listener, Link::Kind kind) {
    const int descriptor = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
    if (descriptor < 0) return;
    if (ended_) {
      ::close(descriptor);
      return;
    }
    links_.push_back({kind, "", FrameStream(descriptor, 1 << 20)});
    if (kind != Link::kClient) return;
    gazebo::msgs::Publishers all;
    *all.add_publisher() = offer("/gazebo/room/pose/info", "gazebo.msgs.PosesStamped");
    gazebo::msgs::Time unused;  // the client does not look into it
    unused.set_sec(0);
    unused.set_nsec(0);
    links_.back().stream.send(packet("version_init", unused));
    links_.back().stream.send(packet("publishers_init", all));
  }

  void take(Link& link, std::string_view frame) {
    if (link.kind == Link::kWriter) {
      if (answer_) send_all(answer_(link.topic, frame));
      if (!link.topic.ends_with("/vel_cmd")) return;
      gazebo::msgs::Pose velocity;
      if (!velocity.ParseFromArray(frame.data(), static_cast<int>(frame.size()))) return;
      velocities_.emplace_back(
          velocity.position().x(),
          2.0 * std::atan2(velocity.orientation().z(), velocity.orientation().w()));
      return;
    }
    gazebo::msgs::Packet in;
    if (!in.ParseFromArray(frame.data(), static_cast<int>(frame.size()))) return;
    gazebo::msgs::Subscribe ask;
    gazebo::msgs::Publish given;
    if (in.type() == "sub" && ask.ParseFromString(in.serialized_data())) {
      link.topic = ask.topic();
      if (listened_) send_all(listened_(link.topic));
    } else if (in.type() == "subscribe" && ask.ParseFromString(in.serialized_data())) {
      link.stream.send(packet("publisher_subscribe", offer(ask.topic(), ask.msg_type())));
    } else if (in.type() == "advertise" && given.ParseFromString(in.serialized_data())) {
      ask.set_topic(given.topic());
      ask.set_host("127.0.0.1");
      ask.set_port(1);
      ask.set_msg_type(given.msg_type());
      FrameStream to =
          FrameStream::connect(given.host(), static_cast<int>(given.port()), 1.0, 1 << 20);
      to.send(packet("sub", ask));
      links_.push_back({Link::kWriter, given.topic(), std::move(to)});
    }
  }

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::vector<pollfd> all = {{master_, POLLIN, 0}, {data_, POLLIN, 0}};
      {
        const std::lock_guard lock(mutex_);
        for (const Link& link : links_) all.push_back({link.stream.descriptor(), POLLIN, 0});
      }
      ::poll(all.data(), all.size(), 2);
      const std::lock_guard lock(mutex_);
      accept(master_, Link::kClient);
      accept(data_, Link::kReader);
      for (Link& link : links_) {
        link.stream.flush();
        link.stream.receive([&](std::string_view frame) { take(link, frame); });
      }
      links_.remove_if([](const Link& link) { return !link.stream.closed().empty(); });
    }
  }

  const Answer answer_;
  const Listened listened_;
  int master_port_ = 0, data_port_ = 0;
  int master_, data_;
  std::mutex mutex_;
  bool ended_ = false;
  std::list<Link> links_;
  std::vector<std::pair<double, double>> velocities_;
  std::jthread thread_;
};

}  // namespace prospect::test
