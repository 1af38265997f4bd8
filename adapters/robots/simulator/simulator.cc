// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/simulator.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "adapters/robots/simulator/camera_sensors.h"
#include "adapters/robots/simulator/feature_sensors.h"
#include "adapters/robots/simulator/kinematic_robot.h"
#include "adapters/robots/simulator/known_free.h"
#include "adapters/robots/simulator/noise_stream.h"
#include "adapters/robots/simulator/seen_area.h"
#include "adapters/robots/simulator/simulated_imu.h"
#include "adapters/robots/simulator/walkers.h"
#include "engine/maps/correction.h"
#include "models/body_transform.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

std::shared_ptr<const World> not_null(std::shared_ptr<const World> world) {
  if (!world) throw std::invalid_argument("simulator: expected a world, got none");
  return world;
}

OccupancyMapperOptions checked_mapping_options(const SimulatorOptions& options,
                                               const OccupancyMapperOptions& mapping) {
  check_knobs("simulator", options);
  check_finite("simulator", "base_height", options.base_height);
  if (const std::string misfit = simulator_misfit(options, mapping); !misfit.empty()) {
    throw std::invalid_argument("simulator: " + misfit);
  }
  return mapping_options(options, mapping);
}

/// Where B's origin starts: a world's start is a place on the floor.
Pose start_of(const World& world, const SimulatorOptions& options) {
  Pose start = world.start;
  start.position.z() = options.base_height;
  return start;
}

/// People on 100 m^2 that cameras meet.
double people_density(const SimulatorOptions& options) {
  if (options.sensors != Sensors::kCamera) return 0.0;
  return scaled(options.camera.effects, options.camera.realism).people;
}

}  // namespace

struct Simulator::Impl {
  std::shared_ptr<const World> world;
  SimulatorOptions options;
  OccupancyMapperOptions mapping;
  KinematicRobot robot;
  SeenArea seen;
  std::optional<Walkers> walkers;
  std::unique_ptr<SimulatedSensors> sensors;
  SimulatedImu imu;
  FrameSink* sink = nullptr;

  double time = 0.0;
  double lost_time = 0.0;
  std::int64_t images = 0;  // taken so far; the next one is due at images / image_rate
  std::int64_t scans = 0;
  Twist twist;                             // being executed
  std::size_t corrected = 0, carried = 0;  // of the options', how many have been

  Impl(std::shared_ptr<const World> w, const SimulatorOptions& o, PerceptionOptions perception)
      : world(not_null(std::move(w))),
        options(o),
        mapping(checked_mapping_options(o, perception.mapping)),
        robot(*world, o.shape, o.actuation, start_of(*world, o),
              stream_seed(o.seed, NoiseStream::kActuation), mapping.slice.step),
        seen(*world, mapping.slice),
        imu(o.imu, stream_seed(o.seed, NoiseStream::kImu)) {
    const std::vector<Disc> cleared = free_about(robot.pose());
    for (const SimulatorOptions::Carried& c : o.carried) {
      Pose to = c.to;
      to.position.z() = robot.pose().position.z();
      check_parameter(!robot.contact_test().in_contact(to), "simulator", "carried", to.position.x(),
                      "places without a wall in the body");
    }
    perception.mapping = mapping;
    if (o.sensors == Sensors::kCamera) {
      sensors = std::make_unique<CameraSensors>(*world, o, perception, robot.pose(), cleared);
    } else {
      sensors = std::make_unique<FeatureSensors>(*world, o, perception, robot.pose(), cleared);
    }
    const double density = people_density(o);
    if (o.walkers.count > 0 || density > 0.0) {
      walkers.emplace(*world, o.walkers, density, robot.pose(),
                      stream_seed(o.seed, NoiseStream::kPeople));
      sensors->among(&*walkers);
      walk();
    }
    if (o.map && o.place_known) seen.know(*sensors->belief(time, robot.pose(), twist)->ground);
    scan();
    image();
    const std::string complaint = sensors->complaint();
    if (!complaint.empty()) throw std::invalid_argument("sensors at the start: " + complaint);
  }

  /// Until now.
  void walk() {
    if (!walkers) return;
    const Pose pose = robot.pose();
    walkers->advance(time, pose, [&](const Eigen::Vector2d& at) {
      return robot.contact_test().touches(pose, {at, kWalkerRadius});
    });
    std::vector<Disc> discs;
    for (const Walker& walker : walkers->walkers()) discs.push_back({walker.at, kWalkerRadius});
    robot.stand_among(std::move(discs));
  }

  static constexpr double kInstant = 1e-9;  // nearer ones are the same

  std::vector<Disc> free_about(const Pose& pose) const {
    return known_free(*world, pose, robot.contact_test().radius(),
                      {mapping.slice.z_min, mapping.slice.z_max}, mapping.resolution);
  }
  void carry() {
    for (; carried < options.carried.size(); ++carried) {
      if (!(options.carried[carried].time <= time + kInstant)) return;
      const Pose from = robot.pose();
      robot.carry_to(options.carried[carried].to);
      const Pose to = robot.pose();
      sensors->carry(from, to, free_about(to));
    }
  }
  void correct() {
    for (; corrected < options.corrections.size(); ++corrected) {
      const ScheduledCorrection& told = options.corrections[corrected];
      if (!(told.time <= time + kInstant)) return;
      Correction correction;
      correction.stamp = told.time;
      correction.T_new_old = body_transform({{told.x, told.y, 0.0}, told.yaw});
      correction.why = "as the mission was told";
      correction.kind = told.kind;
      sensors->correct(correction, robot.pose());
    }
  }
  void scan() {
    ++scans;
    sensors->scan(time, robot.pose(), seen);
  }
  void image() {
    ++images;
    sensors->image(time, robot.pose(), twist);
  }
};

Simulator::Simulator(std::shared_ptr<const World> world, const SimulatorOptions& options,
                     const PerceptionOptions& perception)
    : impl_(std::make_unique<Impl>(std::move(world), options, perception)) {}
Simulator::Simulator(std::shared_ptr<const World> world, const SimulatorOptions& options)
    : Simulator(std::move(world), options, simulated_perception(options)) {}
Simulator::~Simulator() = default;

std::shared_ptr<const Belief> Simulator::sense() {
  Impl& s = *impl_;
  s.carry();
  s.correct();
  return s.sensors->belief(s.time, s.robot.pose(), s.twist);
}

void Simulator::apply(const Twist& twist, double duration) {
  Impl& s = *impl_;
  if (!(duration > 0.0) || !std::isfinite(duration)) return;
  s.twist = twist;
  s.twist.linear.z() = 0.0;
  if (!twist.linear.allFinite() || !std::isfinite(twist.yaw_rate)) s.twist = Twist{};
  // Instants closer than this are one: sums of periods do not meet exactly.
  constexpr double kInstant = 1e-9;
  constexpr double kStride = 0.05;  // [s] of people
  const double end = s.time + duration;
  while (s.time < end - kInstant) {
    const double next_image = static_cast<double>(s.images) / s.options.image_rate;
    const double next_scan = static_cast<double>(s.scans) / s.options.depth_rate;
    double next = std::max(s.time, std::min({end, next_image, next_scan}));
    if (s.walkers) next = std::min(next, s.time + kStride);
    if (next > s.time) {
      const Pose before = s.robot.pose();
      if (!s.robot.move(s.twist, next - s.time)) s.twist = Twist{};
      for (const ImuSample& sample : s.imu.moved(before, s.time, s.robot.pose(), next)) {
        if (s.sink != nullptr) s.sink->observe(sample);
        s.sensors->imu(sample);
      }
      if (s.sensors->localization() == Localization::kLost) s.lost_time += next - s.time;
      s.time = next;
      s.walk();
    }
    if (s.time >= next_image - kInstant) s.image();
    if (s.time >= next_scan - kInstant) s.scan();
  }
  s.time = end;
}

void Simulator::deliver_to(FrameSink* sink) {
  impl_->sink = sink;
  impl_->sensors->deliver_to(sink);
}
void Simulator::leave_ranges() { impl_->sensors->leave_ranges(); }
void Simulator::enter(double stamp, const SensorFrame& ranges) {
  impl_->sensors->enter(stamp, ranges);
}
double Simulator::time() const { return impl_->time; }
const World& Simulator::world() const { return *impl_->world; }
const SimulatorOptions& Simulator::options() const { return impl_->options; }
Pose Simulator::true_pose() const { return impl_->robot.pose(); }
Pose Simulator::estimated_pose() const {
  return impl_->sensors->estimate(impl_->time, impl_->robot.pose());
}
double Simulator::localization_error() const {
  const Pose estimated = impl_->sensors->origin()(estimated_pose());
  return (estimated.position - true_pose().position).head<2>().norm();
}
int Simulator::collisions() const { return impl_->robot.collisions(); }
bool Simulator::fallen() const { return impl_->robot.fallen(); }
bool Simulator::in_contact() const { return impl_->robot.in_contact(); }
std::vector<Walker> Simulator::walkers() const {
  if (!impl_->walkers) return {};
  const std::span<const Walker> now = impl_->walkers->walkers();
  return {now.begin(), now.end()};
}
int Simulator::bumps() const { return impl_->walkers ? impl_->walkers->bumps() : 0; }
double Simulator::path_length() const { return impl_->robot.path_length(); }
double Simulator::rotation() const { return impl_->robot.rotation(); }
int Simulator::losses() const { return impl_->sensors->losses(); }
std::string Simulator::complaint() const { return impl_->sensors->complaint(); }
CameraPicture Simulator::picture() const { return impl_->sensors->picture(); }
double Simulator::lost_time() const { return impl_->lost_time; }
void Simulator::set_reachable(const Grid<std::uint8_t>& reachable) {
  impl_->seen.set_reachable(reachable);
}
double Simulator::coverage() const { return impl_->seen.coverage(); }
double Simulator::seen_area() const { return impl_->seen.area(); }
bool Simulator::seen(Cell true_cell) const { return impl_->seen.seen(true_cell); }

}  // namespace prospect
