// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_links.h"

#include <cmath>
#include <utility>

#include "models/formatted.h"

namespace prospect {
namespace {

std::optional<double> finite(double seconds) {
  return std::isfinite(seconds) ? std::optional(seconds) : std::nullopt;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

std::vector<Link> dds_links(const DdsOptions& o, const SensorInboxOptions& inbox) {
  using enum DriveCause;
  const std::string known_to_tf = "one of " + o.tf + " or " + o.tf_static;
  std::vector<Link> links;
  const auto add = [&](Link link) {
    if (!link.topic.empty()) links.push_back(std::move(link));
  };
  // Whoever takes commands may take them from anybody.
  const auto commands = [&](const char* signal, const std::string& topic) {
    add({.signal = signal,
         .topic = topic,
         .frame = o.frames.base,
         .values = "finite numbers",
         .absent = kBaseSilent,
         .doubled = kBaseFault,
         .wrong = kBaseFault});
  };
  const DdsOptions::Command& c = o.command;
  if (!c.relay.empty()) commands("commands to the relay", c.relay);
  const char* to_driver = c.relay.empty() ? "commands" : "commands of the relay";
  commands(to_driver, c.stamped);
  commands(to_driver, c.plain);
  add({.signal = "odometry",
       .topic = o.odometry,
       .heartbeat = kOdometrySilence,
       .frame = o.odometry_by_tf ? known_to_tf : o.frames.base,
       .values = o.tells_odometry_pose() ? "finite numbers, a unit quaternion"
                                         : "finite numbers, a stamp",
       .absent = kBaseFault,
       .doubled = kBaseFault,
       .wrong = kBaseFault});
  const EmergencyStopContract& stop = o.emergency_stop_contract;
  links.push_back({.signal = "emergency stop",
                   .topic = o.emergency_stop,
                   .least = stop.publishers,
                   .most = 0,
                   .heartbeat = stop.latched ? std::nullopt : std::optional(stop.max_age),
                   .values = "released",
                   .absent = kEmergencyStopSilent,
                   .wrong = kBaseFault});
  add({.signal = "acknowledgement", .topic = o.acknowledge, .least = 0, .most = 0});

  const auto sensor = [&](const char* signal, const std::string& topic, double age,
                          const std::string& frame, const char* values) {
    add({.signal = signal,
         .topic = topic,
         .age = finite(age),
         .frame = frame,
         .values = values,
         .absent = kSourceStale,
         .doubled = kBaseFault,
         .wrong = kSourceStale});
  };
  const auto calibration = [&](const char* signal, const std::string& topic) {
    add({.signal = signal,
         .topic = topic,
         .frame = o.mounts_from_tf ? known_to_tf : "",
         .values = "as at the start",
         .doubled = kBaseFault,
         .wrong = kSourceStale});
  };
  sensor("pose", o.pose.topic, inbox.max_image_age, o.frames.map,
         "a unit quaternion, no variance below 0; one that jumps is a stop");
  constexpr const char* kImage = "size of the calibration";
  sensor("left images", o.stereo.left, inbox.max_image_age, "", kImage);
  sensor("right images", o.stereo.right, inbox.max_image_age, "", kImage);
  calibration("left calibration", o.stereo.left_info);
  calibration("right calibration", o.stereo.right_info);
  sensor("depth images", o.depth.image, inbox.max_range_age, "", kImage);
  calibration("depth calibration", o.depth.info);
  sensor("scans", o.scan, inbox.max_range_age, known_to_tf, "");
  sensor("point clouds", o.point_cloud, inbox.max_range_age, known_to_tf, "");
  for (const DdsOptions::MoreDepth& more : o.more_depth) {
    sensor("more depth images", more.depth.image, inbox.max_range_age, "", kImage);
    calibration("more depth calibration", more.depth.info);
    sensor("more scans", more.scan, inbox.max_range_age, known_to_tf, "");
    sensor("more point clouds", more.point_cloud, inbox.max_range_age, known_to_tf, "");
  }
  sensor("imu", o.imu, inbox.max_wheel_age, known_to_tf, "finite numbers");
  for (const std::string& topic : {o.tf, o.tf_static}) {
    add({.signal = "transforms",
         .topic = topic,
         .least = 0,
         .most = 0,
         .values = "a mount that moves is a base fault",
         .absent = o.pose_source == DdsOptions::PoseSource::kTf ? std::optional(kSourceStale)
                                                                : std::nullopt});
  }
  return links;
}

DdsLinkWatch::DdsLinkWatch(std::vector<Link> links, DdsNode& node)
    : links_(std::move(links)), node_(node) {
  for (const Link& link : links_) {
    if (!link.topic.empty()) node_.watch(link.topic);
  }
}

std::vector<std::string> DdsLinkWatch::faults(double now) {
  constexpr double kMoment = 0.2;  // [s]
  std::vector<std::string> faults;
  for (const Link& link : links_) {
    if (link.topic.empty()) continue;
    if (link.wrong == DriveCause::kBaseFault) {
      if (std::string fault = node_.fault(link.topic); !fault.empty()) {
        faults.push_back(std::move(fault));
      }
    }
    if (link.most == 0) continue;
    const std::vector<std::string> names = node_.publisher_names(link.topic);
    if (names.size() <= static_cast<std::size_t>(link.most)) {
      doubled_since_.erase(link.topic);
      continue;
    }
    const double since = doubled_since_.emplace(link.topic, now).first->second;
    if (now - since < kMoment) continue;
    faults.push_back(link.topic + ": published by " + joined(names) + "; expected " +
                     (link.most == 1 ? "one publisher" : formatted("%d at most", link.most)));
  }
  return faults;
}

}  // namespace prospect
