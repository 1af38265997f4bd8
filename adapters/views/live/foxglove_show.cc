// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/foxglove_show.h"

#include <algorithm>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/images/image_codec.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/goal_pose.h"
#include "adapters/missions/log/step_messages.h"
#include "adapters/views/live/access.h"
#include "adapters/views/live/foxglove_protocol.h"
#include "adapters/views/page/landmark_picture.h"
#include "engine/task/moved.h"

namespace prospect {
namespace {

using namespace nlohmann::literals;

constexpr std::size_t kMostSubscriptions = 256;  // of a viewer, and channels that it publishes on
constexpr std::size_t kMostAnswers = 100;        // that wait for one who does not read

/// A message of a channel, for whoever has subscribed to it.
struct Told {
  std::int64_t time = 0;
  std::shared_ptr<const std::string> bytes;  // null: none yet
};

}  // namespace

struct FoxgloveShow::Impl {
  Impl(const MissionMessageOptions& options, DriveCommands& its_commands)
      : commands(its_commands),
        channels(mission_channels()),
        newest(channels.size()),
        messages(options, [this](std::size_t channel, std::int64_t time, std::string bytes) {
          tell(channel, {time, std::make_shared<std::string>(std::move(bytes))});
        }) {
    for (std::size_t id = 0; id < channels.size(); ++id) {
      const std::string& topic = channels[id].topic;
      large.push_back(topic == "/map" || topic.starts_with("/camera/"));
      // What this view does not tell: commands and raw sensors, which it is not given.
      const std::set<std::string> absent = {"/cmd_vel", "/map_updates", "/scan", "/wheels"};
      const bool raw = topic.starts_with("/camera/") && !topic.starts_with("/camera/landmarks/");
      if (!raw && !absent.contains(topic)) {
        offered.push_back(
            {static_cast<std::uint32_t>(id), topic, channels[id].type, channels[id].definition});
      }
    }
    messages.fixed();
    load_image_codecs();
  }

  void tell(std::size_t channel, Told told);

  DriveCommands& commands;
  const std::vector<McapLog::Channel> channels;
  std::vector<foxglove::Channel> offered;
  std::vector<bool> large;
  std::vector<Told> newest;
  std::set<class FoxgloveViewer*> viewers;
  const std::string session = make_token();
  double stamp = 0.0;  // [s] of the newest pose or step
  Pose map_origin;     // of what is shown, in the frame that goals are told in
  MissionMessages messages;
};

class FoxgloveViewer final : public Viewer {
 public:
  FoxgloveViewer(FoxgloveShow::Impl& show, bool may_command)
      : show_(show), may_command_(may_command) {
    show_.viewers.insert(this);
    say(foxglove::server_info("prospect", show_.session, may_command_));
    say(foxglove::advertise(show_.offered));
    if (may_command_) {
      std::vector<std::string> services;
      for (const std::string& name : DriveCommands::names())
        services.push_back("/prospect/" + name);
      say(foxglove::advertise_services(services));
    }
  }
  ~FoxgloveViewer() override { show_.viewers.erase(this); }
  FoxgloveViewer(const FoxgloveViewer&) = delete;
  FoxgloveViewer& operator=(const FoxgloveViewer&) = delete;

  std::optional<LiveMessage> next() override {
    if (!answers_.empty()) {
      LiveMessage answer = std::move(answers_.front());
      answers_.pop_front();
      return answer;
    }
    if (waiting_.empty()) return std::nullopt;
    const Waiting first = std::move(waiting_.front());
    waiting_.pop_front();
    return LiveMessage{std::make_shared<std::string>(foxglove::message_data(
                           first.subscription, first.told.time, *first.told.bytes)),
                       true};
  }

  bool message(std::string_view bytes, bool text) override {
    const std::optional<foxglove::ClientMessage> message = foxglove::parse(bytes, text);
    if (!message) return false;
    return std::visit([this](const auto& one) { return take(one); }, *message) &&
           answers_.size() <= kMostAnswers;
  }

  std::uint64_t dropped() const override { return dropped_; }

  void tell(std::size_t channel, const Told& told) {
    for (const auto& [subscription, of] : subscriptions_) {
      if (of == channel) wait(subscription, channel, told);
    }
  }

 private:
  struct Waiting {
    std::uint32_t subscription = 0;
    Told told;
  };

  void say(std::string text, bool binary = false) {
    answers_.push_back({std::make_shared<std::string>(std::move(text)), binary});
  }

  void wait(std::uint32_t subscription, std::size_t channel, const Told& told) {
    const auto is_of = [&](const Waiting& waiting) { return waiting.subscription == subscription; };
    const auto count =
        static_cast<std::size_t>(std::count_if(waiting_.begin(), waiting_.end(), is_of));
    if (count >= (show_.large[channel] ? 1 : FoxgloveShow::kWaiting)) {
      waiting_.erase(std::find_if(waiting_.begin(), waiting_.end(), is_of));
      ++dropped_;
    }
    waiting_.push_back({subscription, told});
  }

  bool take(const foxglove::Subscribe& subscribe) {
    for (const foxglove::Subscription& one : subscribe.subscriptions) {
      const bool known =
          std::any_of(show_.offered.begin(), show_.offered.end(),
                      [&](const foxglove::Channel& channel) { return channel.id == one.channel; });
      if (!known || subscriptions_.contains(one.id) ||
          subscriptions_.size() >= kMostSubscriptions) {
        say(foxglove::status(foxglove::Level::kError,
                             "subscription " + std::to_string(one.id) +
                                 ": taken already, or no such channel; expected another"));
        continue;
      }
      subscriptions_[one.id] = one.channel;
      if (show_.newest[one.channel].bytes) wait(one.id, one.channel, show_.newest[one.channel]);
    }
    return true;
  }
  bool take(const foxglove::Unsubscribe& unsubscribe) {
    for (const std::uint32_t id : unsubscribe.ids) {
      subscriptions_.erase(id);
      std::erase_if(waiting_, [&](const Waiting& waiting) { return waiting.subscription == id; });
    }
    return true;
  }
  bool take(const foxglove::ClientAdvertise& advertise) {
    for (const foxglove::ClientChannel& channel : advertise.channels) {
      const bool pose = channel.type == "geometry_msgs/msg/PoseStamped" ||
                        channel.type == "geometry_msgs/PoseStamped";
      const bool known = channel.encoding == "cdr" || channel.encoding == "json";
      if (!may_command_ || !pose || !known || published_.size() >= kMostSubscriptions) {
        say(foxglove::status(
            foxglove::Level::kError,
            channel.topic + ": not taken; expected geometry_msgs/msg/PoseStamped in cdr or json, "
                            "from one who has the token"));
        continue;
      }
      published_[channel.id] = channel.encoding;
    }
    return true;
  }
  bool take(const foxglove::ClientUnadvertise& unadvertise) {
    for (const std::uint32_t id : unadvertise.ids) published_.erase(id);
    return true;
  }
  bool take(const foxglove::ClientData& data) {
    const auto channel = published_.find(data.channel);
    if (channel == published_.end()) {
      say(foxglove::status(foxglove::Level::kError,
                           "channel " + std::to_string(data.channel) +
                               ": not advertised; expected advertise before"));
      return true;
    }
    const std::string refused = go(data.bytes, channel->second);
    if (!refused.empty()) say(foxglove::status(foxglove::Level::kError, "go: " + refused));
    return true;
  }
  bool take(const foxglove::ServiceCall& call) {
    const std::vector<std::string> names = DriveCommands::names();
    if (!may_command_ || call.service >= names.size()) {
      say(foxglove::service_failure(call.service, call.call,
                                    "no such service for one without the token"));
      return true;
    }
    const std::string refused = show_.commands.give(names[call.service]);
    say(foxglove::service_response(call.service, call.call, refused.empty(), refused), true);
    return true;
  }
  bool take(const foxglove::Other& other) {
    say(foxglove::status(foxglove::Level::kWarning, other.op + ": not offered; nothing is done"));
    return true;
  }

  /// Goes where a message says. Empty, or why not.
  std::string go(const std::string& bytes, const std::string& encoding) {
    const std::optional<Sent> sent = sent_in(bytes, encoding);
    if (!sent) return "no pose; expected geometry_msgs/msg/PoseStamped in " + encoding;
    const std::string& frame = sent->pose.header.frame_id;
    if (!frame.empty() && frame != kMapFrame) {
      return "a pose in the frame '" + frame + "'; expected one in " + kMapFrame;
    }
    try {
      const Eigen::Isometry3d T = ros::goal_transform(sent->pose.pose, "pose");
      const ros::FloorGoal goal = ros::floor_goal(T, "pose");
      const Pose& origin = show_.map_origin;
      return show_.commands.go(moved(goal.place, origin),
                               sent->heads ? std::optional(goal.yaw + origin.yaw) : std::nullopt);
    } catch (const InputError& error) {
      return error.what();
    }
  }
  struct Sent {
    ros::PoseStamped pose;
    bool heads = true;  ///< has an orientation
  };
  static std::optional<Sent> sent_in(const std::string& bytes, const std::string& encoding) {
    if (encoding == "cdr") {
      try {
        return Sent{ros::from_cdr<ros::PoseStamped>(bytes, "pose")};
      } catch (const InputError&) {
        return std::nullopt;
      }
    }
    try {
      const nlohmann::json json = nlohmann::json::parse(bytes);
      const nlohmann::json& position = json.at("pose").at("position");
      Sent sent;
      sent.pose.header.frame_id = json.value("/header/frame_id"_json_pointer, std::string());
      sent.pose.pose.position = {position.at("x"), position.at("y"), 0.0};
      const auto turned = json.at("pose").find("orientation");
      sent.heads = turned != json.at("pose").end();
      if (sent.heads) {
        const nlohmann::json& q = *turned;
        sent.pose.pose.orientation = {q.at("x"), q.at("y"), q.at("z"), q.at("w")};
      }
      return sent;
    } catch (const nlohmann::json::exception&) {
      return std::nullopt;
    }
  }

  FoxgloveShow::Impl& show_;
  const bool may_command_;
  std::map<std::uint32_t, std::uint32_t> subscriptions_;  // to the channel
  std::map<std::uint32_t, std::string> published_;        // its channels, to their encoding
  std::deque<LiveMessage> answers_;
  std::deque<Waiting> waiting_;
  std::uint64_t dropped_ = 0;
};

void FoxgloveShow::Impl::tell(std::size_t channel, Told told) {
  newest[channel] = std::move(told);
  for (FoxgloveViewer* viewer : viewers) viewer->tell(channel, newest[channel]);
}

FoxgloveShow::FoxgloveShow(const MissionMessageOptions& options, DriveCommands& commands) {
  MissionMessageOptions whole = options;
  whole.whole_map_every = 0.0;
  impl_ = std::make_unique<Impl>(whole, commands);
}
FoxgloveShow::~FoxgloveShow() = default;

void FoxgloveShow::add(const LiveFeed::News& news) {
  MissionMessages& messages = impl_->messages;
  if (news.pose) {
    impl_->stamp = news.pose->stamp;
    Belief belief;
    belief.stamp = news.pose->stamp;
    belief.pose = news.pose->pose;
    belief.covariance = news.pose->covariance;
    belief.twist = news.pose->twist;
    messages.belief(belief);
  }
  for (const auto& step : news.steps) {
    impl_->stamp = step->stamp;
    if (step->map_frame) impl_->map_origin = step->map_frame->origin;
    messages.step(*step);
  }
  if (!news.events.empty()) messages.events(news.events);
  if (news.driver) {
    std::uint64_t dropped = 0;
    for (const FoxgloveViewer* viewer : impl_->viewers) dropped += viewer->dropped();
    messages.status(news.driver->health.stamp, news.driver->status, "live view",
                    dropped > 0 ? std::to_string(dropped) + " messages dropped" : "");
  }
  if (news.picture && !impl_->viewers.empty()) {
    messages.picture(impl_->stamp, landmark_picture(0, *news.picture->image,
                                                    news.picture->sightings, kLivePictureWidth));
  }
}

std::unique_ptr<Viewer> FoxgloveShow::viewer(bool may_command) {
  return std::make_unique<FoxgloveViewer>(*impl_, may_command);
}

}  // namespace prospect
