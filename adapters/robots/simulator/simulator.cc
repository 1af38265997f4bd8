// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/simulator.h"

#include <algorithm>
#include <cmath>
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

}  // namespace

struct Simulator::Impl {
  std::shared_ptr<const World> world;
  SimulatorOptions options;
  OccupancyMapperOptions mapping;
  KinematicRobot robot;
  SeenArea seen;
  std::unique_ptr<SimulatedSensors> sensors;
  SimulatedImu imu;
  FrameSink* sink = nullptr;

  double time = 0.0;
  double lost_time = 0.0;
  std::int64_t images = 0;  // taken so far; the next one is due at images / image_rate
  std::int64_t scans = 0;
  Twist twist;  // being executed
  Corrections corrections;
  std::size_t corrected = 0;  // of the options', how many were told

  Impl(std::shared_ptr<const World> w, const SimulatorOptions& o, PerceptionOptions perception)
      : world(not_null(std::move(w))),
        options(o),
        mapping(checked_mapping_options(o, perception.mapping)),
        robot(*world, o.shape, o.actuation, start_of(*world, o),
              stream_seed(o.seed, NoiseStream::kActuation), mapping.slice.step),
        seen(*world, mapping.slice),
        imu(o.imu, stream_seed(o.seed, NoiseStream::kImu)) {
    const std::vector<Disc> cleared =
        known_free(*world, robot.pose(), robot.contact_test().radius(),
                   {mapping.slice.z_min, mapping.slice.z_max}, mapping.resolution);
    perception.mapping = mapping;
    if (o.sensors == Sensors::kCamera) {
      sensors = std::make_unique<CameraSensors>(*world, o, perception, robot.pose(), cleared);
    } else {
      sensors = std::make_unique<FeatureSensors>(*world, o, perception, robot.pose(), cleared);
    }
    if (o.sensors == Sensors::kModel && (!o.corrections.empty() || perception.loops)) {
      corrections.expect();
    }
    if (o.map) seen.know(*sensors->belief(time, robot.pose(), twist)->ground);
    scan();
    image();
    const std::string complaint = sensors->complaint();
    if (!complaint.empty()) throw std::invalid_argument("sensors at the start: " + complaint);
  }

  void correct() {
    constexpr double kInstant = 1e-9;
    for (; corrected < options.corrections.size(); ++corrected) {
      const ScheduledCorrection& told = options.corrections[corrected];
      if (!(told.time <= time + kInstant)) return;
      Correction correction;
      correction.stamp = told.time;
      correction.T_new_old = body_transform({{told.x, told.y, 0.0}, told.yaw});
      correction.why = "as the mission was told";
      correction.kind = told.kind;
      if (sensors->correct(correction)) continue;
      const Pose estimated = sensors->estimate(time, robot.pose());
      if (told.kind != CorrectionKind::kRobot) {
        corrections.take(correction, estimated);
      } else if (corrections.refuse(correction, estimated).empty() &&
                 !sensors->move_robot(correction, robot.pose())) {
        corrections.take(correction, estimated);  // cannot be followed
      }
    }
  }
  void follow() {
    const Pose estimated = sensors->estimate(time, robot.pose());
    for (FollowedCorrection& f : sensors->followed()) {
      corrections.followed(f.correction, estimated, std::move(f.moves));
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
    : Simulator(std::move(world), options, simulated_perception(options.wheels)) {}
Simulator::~Simulator() = default;

std::shared_ptr<const Belief> Simulator::sense() {
  Impl& s = *impl_;
  s.correct();
  s.follow();
  std::shared_ptr<const Belief> belief = s.sensors->belief(s.time, s.robot.pose(), s.twist);
  if (!s.corrections.frame()) return belief;
  auto corrected = std::make_shared<Belief>(*belief);
  corrected->map_frame = s.corrections.frame();
  return corrected;
}

void Simulator::apply(const Twist& twist, double duration) {
  Impl& s = *impl_;
  if (!(duration > 0.0) || !std::isfinite(duration)) return;
  s.twist = twist;
  s.twist.linear.z() = 0.0;
  if (!twist.linear.allFinite() || !std::isfinite(twist.yaw_rate)) s.twist = Twist{};
  // Instants closer than this are one: sums of periods do not meet exactly.
  constexpr double kInstant = 1e-9;
  const double end = s.time + duration;
  while (s.time < end - kInstant) {
    const double next_image = static_cast<double>(s.images) / s.options.image_rate;
    const double next_scan = static_cast<double>(s.scans) / s.options.depth_rate;
    const double next = std::max(s.time, std::min({end, next_image, next_scan}));
    if (next > s.time) {
      const Pose before = s.robot.pose();
      if (!s.robot.move(s.twist, next - s.time)) s.twist = Twist{};
      for (const ImuSample& sample : s.imu.moved(before, s.time, s.robot.pose(), next)) {
        if (s.sink != nullptr) s.sink->observe(sample);
      }
      if (s.sensors->localization() == Localization::kLost) s.lost_time += next - s.time;
      s.time = next;
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
