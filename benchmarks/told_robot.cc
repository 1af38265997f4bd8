// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/told_robot.h"

#include <utility>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/run/live_perception.h"
#include "models/body_transform.h"

namespace prospect {
namespace {

PerceptionOptions perception_of(const Configuration& c, const Pose& start, LocalizedBy by) {
  PerceptionOptions options = live_perception(c, {}, start);
  options.wheels = by == LocalizedBy::kWheels;
  return options;
}

}  // namespace

LocalizedBy localized_by(const std::string& name) {
  if (name == "cameras") return LocalizedBy::kCameras;
  if (name == "wheels") return LocalizedBy::kWheels;
  if (name == "pose") return LocalizedBy::kPose;
  throw InputError("--by: '" + name + "'; expected cameras, wheels or pose");
}

BaseReport ToldBase::report() {
  BaseReport report = base_.report();
  if (by_ == LocalizedBy::kWheels) {
    // What acts now has acted since the report before.
    const Twist& v = report.velocity;
    report.wheels = {{report.stamp, v.linear.head<2>(), v.yaw_rate}};
  }
  if (by_ == LocalizedBy::kPose) {
    const std::lock_guard lock(mutex_);
    report.velocity = told_.velocity().value_or(Twist());
    report.velocity_of_poses = true;
  }
  return report;
}

void ToldBase::told(const ExternalPose& pose) {
  const std::lock_guard lock(mutex_);
  told_.add(pose.stamp, pose.T_WB);
}

ToldBeliefs::ToldBeliefs(ToldBase& base, Simulator& simulator, const Clock& clock,
                         SensorInbox& inbox, FrameSink& frames, double period,
                         const Configuration& configuration)
    : base_(base),
      simulator_(simulator),
      clock_(clock),
      inbox_(inbox),
      frames_(frames),
      period_(period),
      perception_(perception_of(configuration, simulator.true_pose(), base.by())),
      updated_(clock.now()),
      random_(simulator.options().seed) {
  clear_start(perception_.map(), configuration, simulator.true_pose());
  simulator_.deliver_to(this);
  simulator_.leave_ranges();
}

ToldBeliefs::~ToldBeliefs() { simulator_.deliver_to(nullptr); }

void ToldBeliefs::observe(const SensorFrame& measured) {
  if (const auto* imu = std::get_if<ImuSample>(&measured)) {
    ImuSample later = *imu;
    later.stamp += base_.motors().start();
    frames_.observe(later);
  }
  const auto* scan = std::get_if<ScanFrame>(&measured);
  if (!scan) return;
  ScanFrame later = *scan;
  later.stamp += base_.motors().start();
  later.pose = nullptr;  // of a model of cameras
  frames_.observe(later);
}

void ToldBeliefs::tell_pose() {
  constexpr double kSigma = 0.002;  // [m], [rad]
  std::normal_distribution<double> noise(0.0, kSigma);
  Pose pose = simulator_.true_pose();
  pose.position.x() += noise(random_);
  pose.position.y() += noise(random_);
  pose.yaw += noise(random_);
  ExternalPose told{.stamp = updated_, .T_WB = body_transform(pose)};
  told.covariance.diagonal() << kSigma * kSigma, kSigma * kSigma, 0.0, kSigma * kSigma;
  base_.told(told);
  frames_.observe(told);
}

std::shared_ptr<const Belief> ToldBeliefs::update(const std::stop_token& stop) {
  if (!clock_.wait_until(updated_ + period_, stop)) return nullptr;
  updated_ = clock_.now();
  base_.motors().advance(updated_);
  if (base_.by() == LocalizedBy::kPose) tell_pose();
  while (const std::optional<SensorFrame> frame = inbox_.take()) feed(perception_, *frame);
  return perception_.belief();
}

}  // namespace prospect
