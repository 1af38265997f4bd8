// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_node.h"

#include "adapters/formats/files/not_built_in.h"

#ifdef PROSPECT_WITH_PROTOBUF

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <list>
#include <map>
#include <utility>

#include "adapters/formats/files/input_error.h"
#include "adapters/robots/gazebo/frame_stream.h"
#include "adapters/robots/gazebo/messages.pb.h"

namespace prospect {
namespace {

namespace msgs = gazebo::msgs;
using SteadyTime = std::chrono::steady_clock;

std::string packet(const std::string& type, const google::protobuf::Message& content) {
  msgs::Packet out;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  out.mutable_stamp()->set_sec(
      static_cast<int>(std::chrono::duration_cast<std::chrono::seconds>(now).count()));
  out.mutable_stamp()->set_nsec(0);
  out.set_type(type);
  out.set_serialized_data(content.SerializeAsString());
  return out.SerializeAsString();
}

}  // namespace

struct GazeboNode::Impl {
  struct Source {  // a publisher that a topic comes from
    std::string topic, where;
    FrameStream stream;
  };
  struct Subscriber {
    std::string topic;  // empty: it has not said yet
    FrameStream stream;
  };

  explicit Impl(const GazeboAddress& given)
      : address(given),
        master(FrameStream::connect(given.host, given.port, given.timeout, given.frame_limit)) {
    listen();
    const auto until = SteadyTime::now() + std::chrono::duration<double>(address.timeout);
    while (!greeted && master.closed().empty() && SteadyTime::now() < until) spin(0.05, -1);
    if (!greeted) {
      throw InputError(address.host + ":" + std::to_string(address.port) + ": " +
                       (master.closed().empty() ? "no greeting" : master.closed()) +
                       "; expected a master of Gazebo 11");
    }
  }
  ~Impl() {
    if (listener >= 0) ::close(listener);
  }

  void listen() {
    // The address by which the master is reached is the one at which others reach us.
    sockaddr_in own{};
    socklen_t size = sizeof own;
    ::getsockname(master.descriptor(), reinterpret_cast<sockaddr*>(&own), &size);
    std::array<char, INET_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET, &own.sin_addr, text.data(), text.size());
    host = text.data();
    own.sin_port = 0;
    listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (listener < 0 || ::bind(listener, reinterpret_cast<sockaddr*>(&own), sizeof own) != 0 ||
        ::listen(listener, 8) != 0) {
      throw InputError(host + ": no port to listen at; expected one that is free");
    }
    ::getsockname(listener, reinterpret_cast<sockaddr*>(&own), &size);
    port = ntohs(own.sin_port);
  }

  /// One fault of a kind: the newest.
  void fault(const std::string& kind, const std::string& what) {
    const std::string line = kind + ": " + what;
    for (std::string& known : faults) {
      if (known.rfind(kind + ": ", 0) == 0) {
        known = line;
        return;
      }
    }
    faults.push_back(line);
  }

  void forget(const msgs::Publish& gone) {
    std::erase_if(topics, [&](const GazeboTopic& t) { return t.name == gone.topic(); });
  }

  void from_master(std::string_view frame) {
    msgs::Packet in;
    if (!in.ParseFromArray(frame.data(), static_cast<int>(frame.size()))) {
      fault("master", "a packet that cannot be read");
      return;
    }
    const std::string& type = in.type();
    msgs::Publish one;
    if (type == "publishers_init") {
      msgs::Publishers all;
      if (!all.ParseFromString(in.serialized_data())) {
        fault("master", "a list of publishers that cannot be read");
        return;
      }
      for (const msgs::Publish& p : all.publisher()) topics.push_back({p.topic(), p.msg_type()});
      greeted = true;
    } else if (type == "publisher_add" && one.ParseFromString(in.serialized_data())) {
      topics.push_back({one.topic(), one.msg_type()});
    } else if (type == "publisher_del" && one.ParseFromString(in.serialized_data())) {
      forget(one);
    } else if ((type == "publisher_update" || type == "publisher_subscribe" ||
                type == "publisher_advertise") &&
               one.ParseFromString(in.serialized_data())) {
      reach(one);
    }
  }

  /// Connects to a publisher of what is subscribed to.
  void reach(const msgs::Publish& to) {
    const std::string where = to.host() + ":" + std::to_string(to.port());
    if (!handlers.contains(to.topic()) || (to.host() == host && to.port() == port)) return;
    for (const Source& s : sources) {
      if (s.topic == to.topic() && s.where == where && s.stream.closed().empty()) return;
    }
    // One that is gone has come back.
    sources.remove_if(
        [&](const Source& s) { return s.topic == to.topic() && !s.stream.closed().empty(); });
    try {
      sources.push_back({to.topic(), where,
                         FrameStream::connect(to.host(), static_cast<int>(to.port()),
                                              address.timeout, address.frame_limit)});
    } catch (const InputError& error) {
      fault(to.topic(), error.what());
      return;
    }
    msgs::Subscribe ask;
    ask.set_topic(to.topic());
    ask.set_host(host);
    ask.set_port(port);
    ask.set_msg_type(to.msg_type());
    sources.back().stream.send(packet("sub", ask));
  }

  void from_subscriber(Subscriber& subscriber, std::string_view frame) {
    msgs::Packet in;
    msgs::Subscribe ask;
    if (in.ParseFromArray(frame.data(), static_cast<int>(frame.size())) && in.type() == "sub" &&
        ask.ParseFromString(in.serialized_data())) {
      subscriber.topic = ask.topic();
    }
  }

  void deliver(const std::string& topic, std::string_view message) {
    try {
      handlers.at(topic)(message);
    } catch (const std::exception& error) {
      fault(topic, error.what());
    } catch (...) {
      fault(topic, "the handler failed");
    }
  }

  void accept() {
    for (int fd = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC); fd >= 0;
         fd = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC)) {
      subscribers.push_back({"", FrameStream(fd, address.frame_limit)});
    }
  }

  bool wait(double seconds, int also) {
    std::vector<pollfd> all;
    const auto add = [&](const FrameStream& s) {
      if (s.descriptor() < 0) return;
      const int events = POLLIN | (s.waits_to_send() ? POLLOUT : 0);
      all.push_back({s.descriptor(), static_cast<short>(events), 0});
    };
    all.push_back({also, POLLIN, 0});
    if (listener >= 0) all.push_back({listener, POLLIN, 0});
    add(master);
    for (const Source& s : sources) add(s.stream);
    for (const Subscriber& s : subscribers) add(s.stream);
    const int milliseconds = static_cast<int>(std::ceil(1e3 * std::max(seconds, 0.0)));
    ::poll(all.data(), all.size(), milliseconds);
    return also >= 0 && all.front().revents != 0;
  }

  void work() {
    accept();
    const bool stood = master.closed().empty();
    master.flush();
    master.receive([&](std::string_view frame) { from_master(frame); });
    if (stood && !master.closed().empty()) fault("master", master.closed());
    for (Source& s : sources) {
      if (!s.stream.closed().empty()) continue;
      s.stream.flush();
      s.stream.receive([&](std::string_view frame) { deliver(s.topic, frame); });
      if (!s.stream.closed().empty()) fault(s.topic, s.stream.closed());
    }
    for (Subscriber& s : subscribers) {
      s.stream.flush();
      s.stream.receive([&](std::string_view frame) { from_subscriber(s, frame); });
      if (!s.stream.closed().empty() && !s.topic.empty()) fault(s.topic, s.stream.closed());
    }
    subscribers.remove_if([](const Subscriber& s) { return !s.stream.closed().empty(); });
  }

  void spin(double seconds, int also) {
    const auto until = SteadyTime::now() + std::chrono::duration<double>(seconds);
    for (;;) {
      const double left = std::chrono::duration<double>(until - SteadyTime::now()).count();
      const bool asked = wait(left, also);
      work();
      if (asked || left <= 0.0) return;
    }
  }

  GazeboAddress address;
  FrameStream master;
  std::string host;
  int listener = -1;
  unsigned port = 0;
  bool greeted = false;
  std::vector<GazeboTopic> topics;
  std::map<std::string, Handler> handlers;
  std::list<Source> sources;  // a handler may subscribe while one is read
  std::list<Subscriber> subscribers;
  std::vector<std::string> faults;
};

GazeboNode::GazeboNode(const GazeboAddress& address) : impl_(std::make_unique<Impl>(address)) {}
GazeboNode::~GazeboNode() = default;

const std::vector<GazeboTopic>& GazeboNode::topics() const { return impl_->topics; }

std::string GazeboNode::world() const {
  static constexpr std::string_view kBegin = "/gazebo/", kEnd = "/pose/info";
  for (const GazeboTopic& topic : impl_->topics) {
    const std::string_view name = topic.name;
    if (name.starts_with(kBegin) && name.ends_with(kEnd) &&
        name.size() > kBegin.size() + kEnd.size()) {
      return std::string(name.substr(kBegin.size(), name.size() - kBegin.size() - kEnd.size()));
    }
  }
  return "";
}

void GazeboNode::subscribe(const std::string& topic, const std::string& type, Handler handler) {
  impl_->handlers[topic] = std::move(handler);
  msgs::Subscribe ask;
  ask.set_topic(topic);
  ask.set_host(impl_->host);
  ask.set_port(impl_->port);
  ask.set_msg_type(type);
  impl_->master.send(packet("subscribe", ask));
}

int GazeboNode::publishers(const std::string& topic) const {
  return static_cast<int>(std::count_if(
      impl_->sources.begin(), impl_->sources.end(),
      [&](const Impl::Source& s) { return s.topic == topic && s.stream.closed().empty(); }));
}

void GazeboNode::advertise(const std::string& topic, const std::string& type) {
  msgs::Publish offer;
  offer.set_topic(topic);
  offer.set_msg_type(type);
  offer.set_host(impl_->host);
  offer.set_port(impl_->port);
  impl_->master.send(packet("advertise", offer));
}

int GazeboNode::subscribers(const std::string& topic) const {
  return static_cast<int>(std::count_if(impl_->subscribers.begin(), impl_->subscribers.end(),
                                        [&](const auto& s) { return s.topic == topic; }));
}

void GazeboNode::publish(const std::string& topic, std::string_view message) {
  for (Impl::Subscriber& s : impl_->subscribers) {
    if (s.topic == topic) s.stream.send(message);
  }
}

void GazeboNode::spin(double seconds, int also) { impl_->spin(seconds, also); }

bool GazeboNode::connected() const {
  return impl_->master.closed().empty() &&
         std::all_of(impl_->sources.begin(), impl_->sources.end(),
                     [](const Impl::Source& s) { return s.stream.closed().empty(); });
}

const std::vector<std::string>& GazeboNode::faults() const { return impl_->faults; }

}  // namespace prospect

#else

namespace prospect {

struct GazeboNode::Impl {
  std::vector<GazeboTopic> topics;
  std::vector<std::string> faults;
};
GazeboNode::GazeboNode(const GazeboAddress&) {
  throw NotBuiltIn("the transport of Gazebo", "libprotobuf-dev and protobuf-compiler");
}
GazeboNode::~GazeboNode() = default;
const std::vector<GazeboTopic>& GazeboNode::topics() const { return impl_->topics; }
std::string GazeboNode::world() const { return ""; }
void GazeboNode::subscribe(const std::string&, const std::string&, Handler) {}
int GazeboNode::publishers(const std::string&) const { return 0; }
void GazeboNode::advertise(const std::string&, const std::string&) {}
int GazeboNode::subscribers(const std::string&) const { return 0; }
void GazeboNode::publish(const std::string&, std::string_view) {}
void GazeboNode::spin(double, int) {}
bool GazeboNode::connected() const { return false; }
const std::vector<std::string>& GazeboNode::faults() const { return impl_->faults; }

}  // namespace prospect

#endif
