// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/stepped_gazebo.h"

#include "adapters/formats/files/not_built_in.h"

#ifdef PROSPECT_WITH_PROTOBUF

#include <algorithm>
#include <cmath>
#include <deque>
#include <exception>
#include <optional>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/robots/gazebo/gazebo_messages.h"
#include "adapters/robots/gazebo/gazebo_node.h"
#include "adapters/robots/gazebo/messages.pb.h"
#include "adapters/robots/gazebo/wheel_encoder.h"
#include "models/formatted.h"
#include "runtime/clock.h"

namespace prospect {
namespace {

namespace msgs = gazebo::msgs;

constexpr double kPoll = 0.001;      // [s]
constexpr double kPoseEvery = 0.02;  // [s] of the machine; Gazebo's own limit is 1/60
constexpr double kPosePatience = 0.05;
constexpr double kAskAgain = 0.5;  // [s] of the machine
constexpr double kWarmUp = 1.0;    // [s] of the simulation
constexpr double kHeard = 5.0;  // [s] of the machine in which a publisher has heard of who listens
constexpr double kRounding = 1e-6;  // of a step

double time_of(const msgs::Time& time) { return time.sec() + 1e-9 * time.nsec(); }

template <typename Message>
Message parsed(std::string_view bytes) {
  Message message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    throw InputError("gazebo: an answer that cannot be read; expected Gazebo 11");
  }
  return message;
}

/// A camera and its frames that wait until they are due.
struct SteppedCamera {
  std::string what;
  double rate = 0.0;  // [Hz]
  std::int64_t received = 0, taken = 0;
  std::deque<SensorFrame> waiting;

  /// The first step at or after its time.
  std::int64_t instant(std::int64_t frame, double step) const {
    return static_cast<std::int64_t>(
        std::ceil(static_cast<double>(frame) / (rate * step) - kRounding));
  }
  std::int64_t due(std::int64_t frame, double step) const { return instant(frame, step) + 1; }
  /// [s] from the instant that its first frame fixes to the stamp.
  double off(std::int64_t frame, double stamp, double step) const {
    const double first = static_cast<double>(instant(1, step)) * step;
    return stamp - first - static_cast<double>(frame - 1) / rate;
  }
  std::int64_t next_due(double step) const { return due(taken + 1, step); }
};

}  // namespace

struct SteppedGazebo::Impl {
  explicit Impl(const GazeboOptions& given) : options(given), node(given.address), encoder(given) {
    world = gazebo_world_name(options, node);
    stereo.what = options.stereo;
    for (const std::string& name : gazebo_depth_names(options)) depths.emplace_back().what = name;
    connect();
    const msgs::Physics physics = parsed<msgs::Physics>(ask("physics_info", ""));
    step = physics.max_step_size();
    if (!(std::isfinite(step) && step > 0.0)) {
      throw InputError("gazebo: physics without a step; expected max_step_size > 0");
    }
    describe_robot();
    connect_robot();
    warm_up();
  }

  /// Stands where each camera takes its first frame, until it has: it takes it at whichever of its
  /// instants it looks first, and all others by that one. Then until they surely have heard of who
  /// listens. What they show until then is left.
  void warm_up() {
    const auto end = static_cast<std::int64_t>(std::llround(kWarmUp / step));
    node.publish(of_robot("vel_cmd"), gazebo_velocity({}, options.turned_yaw));
    ask("physics_info", "");
    const auto going_on = [&](bool goes_on) {
      if (!goes_on) throw InputError("gazebo: " + fault + "; expected a world that goes on");
    };
    std::vector<SteppedCamera*> by_instant = cameras();
    for (SteppedCamera* camera : by_instant) {
      while (camera->next_due(step) <= end) ++camera->taken;
    }
    std::sort(by_instant.begin(), by_instant.end(),
              [](const auto* a, const auto* b) { return a->rate > b->rate; });
    for (const SteppedCamera* camera : by_instant) {
      if (camera->instant(1, step) > steps) going_on(go_to(camera->instant(1, step)));
      going_on(wait("frame of '" + camera->what + "'", [&] { return camera->received > 0; }));
    }
    const Told nobody{[](const SensorFrame&) {}};
    while (steps < end) {
      const std::int64_t next = steps + std::max<std::int64_t>(1, std::llround(0.06 / step));
      going_on(burst(std::min(end, next), nobody));
    }
  }

  std::string topic(const std::string& name) const { return "/gazebo/" + world + "/" + name; }
  std::string of_robot(const std::string& name) const { return topic(options.model + "/" + name); }
  void publish(const std::string& name, const google::protobuf::Message& message) {
    node.publish(topic(name), message.SerializeAsString());
  }
  bool wait(const std::string& what, const std::function<bool()>& done) {
    const double end = machine.now() + options.silence;
    while (!done()) {
      if (!refused.empty()) {
        fault =
            refused + "; expected a server that waits for its sensors (--lockstep), started anew";
        return false;
      }
      if (!node.connected()) {
        fault = node.faults().empty() ? "a connection has closed" : node.faults().back();
        return false;
      }
      if (machine.now() > end) {
        fault = "no " + what + formatted(" within %g s", options.silence);
        return false;
      }
      node.spin(kPoll);
    }
    return true;
  }
  void require(const std::function<bool()>& done, const std::string& expected) {
    if (!wait("answer", done)) throw InputError("gazebo: " + fault + "; expected " + expected);
  }

  void connect() {
    node.subscribe(topic("world_stats"), "gazebo.msgs.WorldStatistics",
                   [this](std::string_view bytes) {
                     const auto in = parsed<msgs::WorldStatistics>(bytes);
                     if (!begun) begun = {time_of(in.sim_time()), in.paused()};
                     // Contacts tell it sooner, but not of a step that has none.
                     stepped = std::max(stepped, time_of(in.sim_time()));
                   });
    node.subscribe(topic("response"), "gazebo.msgs.Response", [this](std::string_view bytes) {
      auto in = parsed<msgs::Response>(bytes);
      if (in.id() == request) response = std::move(in);
    });
    node.advertise(topic("world_control"), "gazebo.msgs.WorldControl");
    node.advertise(topic("request"), "gazebo.msgs.Request");
    require(
        [&] {
          return begun && node.publishers(topic("response")) > 0 &&
                 node.subscribers(topic("world_control")) > 0 &&
                 node.subscribers(topic("request")) > 0;
        },
        "a world of Gazebo 11");
    if (begun->second && begun->first == 0.0) return;
    throw InputError(
        formatted("gazebo: the world %s, at %.3f s; expected one that stands at its "
                  "beginning (scripts/gazebo start --paused)",
                  begun->second ? "has run" : "runs", begun->first));
  }

  /// What is answered to a request; empty: there is no such thing. Throws InputError.
  std::string ask(const std::string& what, const std::string& of) {
    if (!send(what, of)) throw InputError("gazebo: " + fault + "; expected an answer to " + what);
    return response->response() == "success" ? response->serialized_data() : "";
  }
  bool send(const std::string& what, const std::string& of) {
    response.reset();
    msgs::Request out;
    out.set_id(++request);
    out.set_request(what);
    out.set_data(of);
    // Who answers may not have heard yet that somebody listens.
    double again = machine.now();
    return wait("answer to " + what, [&] {
      if (!response && machine.now() >= again) {
        publish("request", out);
        again = machine.now() + kAskAgain;
      }
      return response.has_value();
    });
  }

  void describe_robot() {
    const std::string answer = ask("entity_info", options.model);
    if (answer.empty()) {
      throw InputError("gazebo.model: no '" + options.model + "' in the world '" + world +
                       "'; expected a model of that name");
    }
    const auto model = parsed<msgs::Model>(answer);
    for (const msgs::Link& link : model.link()) {
      for (const msgs::Sensor& sensor : link.sensor()) {
        for (SteppedCamera* camera : cameras()) {
          if (sensor.name() == camera->what) camera->rate = sensor.update_rate();
        }
      }
    }
    const GazeboPoses begin = poses_of(model);
    encoder.add(begin);
    start = pose_of(begin.poses.back());
    for (const SteppedCamera* camera : cameras()) {
      if (camera->rate > 0.0 && camera->rate * step <= 0.4) continue;
      throw InputError("gazebo: sensor '" + camera->what +
                       formatted("' at %g Hz, with steps of %g s", camera->rate, step) +
                       "; expected one with an update rate below 0.4 of the physics'");
    }
  }
  std::vector<SteppedCamera*> cameras() {
    std::vector<SteppedCamera*> all = {&stereo};
    for (SteppedCamera& depth : depths) all.push_back(&depth);
    return all;
  }
  /// Of its links, then its own.
  GazeboPoses poses_of(const msgs::Model& model) const {
    GazeboPoses out;
    const auto add = [&](const std::string& name, const msgs::Pose& pose) {
      const msgs::Vector3d& t = pose.position();
      const msgs::Quaternion& q = pose.orientation();
      out.poses.push_back({name, {t.x(), t.y(), t.z()}, {q.w(), q.x(), q.y(), q.z()}});
    };
    for (const msgs::Link& link : model.link()) add(link.name(), link.pose());
    add(options.model, model.pose());
    return out;
  }
  static Pose pose_of(const GazeboPoses::Named& model) {
    const Eigen::Vector3d ahead = model.orientation * Eigen::Vector3d::UnitX();
    return {model.position, std::atan2(ahead.y(), ahead.x())};
  }

  void connect_robot() {
    std::vector<std::string> all = {topic("pose/info"), topic("physics/contacts"),
                                    of_robot(options.link + "/" + options.stereo + "/images")};
    node.subscribe(all[0], "gazebo.msgs.PosesStamped",
                   [this](std::string_view bytes) { poses = read_gazebo_poses(bytes); });
    node.subscribe(all[1], "gazebo.msgs.Contacts", [this](std::string_view bytes) {
      stepped = std::max(stepped, time_of(parsed<msgs::Contacts>(bytes).time()));
    });
    node.subscribe(all[2], "gazebo.msgs.ImagesStamped", [this](std::string_view bytes) {
      GazeboPair pair = read_gazebo_pair(bytes);
      GazeboImageNoise{options.image_noise, options.seed}.add(pair);
      take(stereo,
           StereoFrame{pair.stamp, pair.stamp,
                       std::make_shared<const Image>(std::move(pair.images.left)),
                       std::make_shared<const Image>(std::move(pair.images.right))},
           pair.stamp);
    });
    for (std::size_t n = 0; n < depths.size(); ++n) {
      all.push_back(of_robot(options.link + "/" + depths[n].what + "/image"));
      node.subscribe(all.back(), "gazebo.msgs.ImageStamped", [this, n](std::string_view bytes) {
        GazeboDepth image = read_gazebo_depth(bytes, options.depth_range);
        const double stamp = image.stamp;
        take(depths[n],
             DepthFrame{stamp, std::make_shared<const DepthImage>(std::move(image.image)),
                        static_cast<int>(n)},
             stamp);
      });
    }
    node.advertise(of_robot("vel_cmd"), "gazebo.msgs.Pose");
    require(
        [&] {
          return node.subscribers(of_robot("vel_cmd")) > 0 &&
                 std::all_of(all.begin(), all.end(),
                             [&](const std::string& name) { return node.publishers(name) > 0; });
        },
        "cameras of '" + options.model + "' and a plug-in that takes its velocity");
  }

  void take(SteppedCamera& camera, SensorFrame frame, double stamp) {
    const auto number =
        static_cast<std::int64_t>(std::floor((stamp + 0.5 * step) * camera.rate + kRounding));
    if (std::abs(camera.off(number, stamp, step)) > 0.6 * step) {
      refused = "a frame of '" + camera.what + formatted("' at %.3f s", stamp);
    }
    if (number <= camera.received) return;
    camera.received = number;
    if (number <= camera.taken) return;  // of the warm-up
    camera.waiting.push_back(std::move(frame));
  }

  double at(std::int64_t count) const { return static_cast<double>(count) * step; }

  bool go_to(std::int64_t count) {
    msgs::WorldControl control;
    control.set_multi_step(static_cast<std::uint32_t>(count - steps));
    if (steps == 0) control.set_seed(static_cast<std::uint32_t>(options.seed));
    publish("world_control", control);
    steps = count;
    return wait(formatted("step to %.3f s", at(count)),
                [&] { return stepped > at(count) - 0.5 * step; });
  }

  /// Those of the world that stands at this step: as it tells them by itself, or asked for.
  bool look_at_poses() {
    const double end = machine.now() + kPosePatience;
    while (poses.stamp < at(steps) - 0.5 * step && machine.now() < end) node.spin(kPoll);
    if (poses.stamp < at(steps) - 0.5 * step) {
      if (!send("entity_info", options.model)) return false;
      poses = poses_of(parsed<msgs::Model>(response->serialized_data()));
    }
    poses.stamp = at(steps);
    return true;
  }

  /// To that step, and what is due there.
  bool burst(std::int64_t count, const Told& told) {
    if (count - steps > 1 && !go_to(count - 1)) return false;
    const double pause = machine.now() + kPoseEvery;
    while (machine.now() < pause) node.spin(kPoll);
    if (!go_to(count) || !look_at_poses()) return false;
    if (const std::optional<WheelSample> sample = encoder.add(poses)) told.frame(*sample);
    if (const GazeboPoses::Named* robot = poses.find(options.model); robot && told.pose) {
      told.pose(poses.stamp, pose_of(*robot));
    }
    std::vector<SensorFrame> due;
    for (SteppedCamera* camera : cameras()) {
      for (; camera->next_due(step) <= count; ++camera->taken) {
        if (!wait("frame of '" + camera->what + "'", [&] { return !camera->waiting.empty(); })) {
          fault += "; expected a server that waits for its sensors (--lockstep)";
          return false;
        }
        due.push_back(std::move(camera->waiting.front()));
        camera->waiting.pop_front();
      }
    }
    std::stable_sort(due.begin(), due.end(), [](const SensorFrame& a, const SensorFrame& b) {
      return stamp_of(a) < stamp_of(b);
    });
    for (const SensorFrame& frame : due) told.frame(frame);
    return true;
  }

  void advance(const Twist& command, double until, const Told& told) {
    const auto end = static_cast<std::int64_t>(std::llround(until / step));
    if (!fault.empty() || end <= steps) return;
    node.publish(of_robot("vel_cmd"), gazebo_velocity(command, options.turned_yaw));
    if (!send("physics_info", "")) return;
    while (steps < end) {
      if (!burst(std::min(end, std::max(steps + 1, stereo.next_due(step))), told)) return;
    }
  }

  GazeboOptions options;
  SteadyClock machine;
  GazeboNode node;
  WheelEncoder encoder;
  std::string world, fault;
  std::string refused;                           // a frame that cannot be
  std::optional<std::pair<double, bool>> begun;  // [s], and whether it stood
  Pose start;
  double step = 0.0;  // [s]
  std::int64_t steps = 0;
  double stepped = 0.0;  // [s] of the newest step that was told of
  GazeboPoses poses;     // the newest
  SteppedCamera stereo;
  std::vector<SteppedCamera> depths;  // by number
  int request = 1 << 20;
  std::optional<msgs::Response> response;
};

SteppedGazebo::SteppedGazebo(const GazeboOptions& options) {
  check(options);
  impl_ = std::make_unique<Impl>(options);
}
SteppedGazebo::~SteppedGazebo() = default;

void SteppedGazebo::advance(const Twist& command, double until, const Told& told) noexcept {
  try {
    impl_->advance(command, until, told);
  } catch (const std::exception& error) {
    impl_->fault = error.what();
  }
}

double SteppedGazebo::time() const { return impl_->at(impl_->steps); }
const std::string& SteppedGazebo::world() const { return impl_->world; }
const Pose& SteppedGazebo::start() const { return impl_->start; }
const std::string& SteppedGazebo::fault() const { return impl_->fault; }

}  // namespace prospect

#else

namespace prospect {

struct SteppedGazebo::Impl {
  std::string none;
  Pose start;
};
SteppedGazebo::SteppedGazebo(const GazeboOptions&) {
  throw NotBuiltIn("the transport of Gazebo", "libprotobuf-dev and protobuf-compiler");
}
SteppedGazebo::~SteppedGazebo() = default;
void SteppedGazebo::advance(const Twist&, double, const Told&) noexcept {}
double SteppedGazebo::time() const { return 0.0; }
const std::string& SteppedGazebo::world() const { return impl_->none; }
const Pose& SteppedGazebo::start() const { return impl_->start; }
const std::string& SteppedGazebo::fault() const { return impl_->none; }

}  // namespace prospect

#endif
