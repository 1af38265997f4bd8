// SPDX-License-Identifier: Apache-2.0
// view_loops [--worlds LIST] [--seed N] [--length L] [--realism X] [--json]: places that are known
// again by their looks (perception/places/view_loops.h), against the truth. A tour (tour.h) of so
// many metres through each world, and all of it back the other way round; rendered cameras, the
// odometry, and loops from its keyframes.
//
//   revisits   views from which an older one, not among the newest, was taken within 3 m and 30
//              degrees in free sight: how many, and of how many of them a right loop is used
//   used       loops that are used; of them wrong ones, off by more than 0.3 m or 5 degrees
//   NEES       of the loops used: their squared errors over what is claimed, a degree of freedom
//   ATE        of the views [m], the first pose aligned: by the odometry, and with all loops
//   ms         of the processor, a view: median, mean and 95 %
// Odometry and loops are told by how far calibrations are off, as in missions by camera.
// Same arguments, same numbers, but for the times.

#include "perception/places/view_loops.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/robots/simulator/camera_effects.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "adapters/robots/simulator/exposure_control.h"
#include "adapters/robots/simulator/feature_field.h"
#include "adapters/robots/simulator/noise_stream.h"
#include "adapters/robots/simulator/scene_renderer.h"
#include "adapters/robots/simulator/world_mesh.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "benchmarks/tour.h"
#include "engine/support/quantile.h"
#include "engine/support/stopwatch.h"
#include "models/body_transform.h"
#include "perception/odometry/se3.h"
#include "perception/odometry/stereo_odometry.h"

namespace prospect {
namespace {

constexpr double kPeriod = 0.1;  // [s] of images and commands
constexpr double kNear = 3.0, kTurned = std::numbers::pi / 6.0;
constexpr double kWrong = 0.3, kWrongTurn = 5.0 * std::numbers::pi / 180.0;

/// Poses a tour long, a turn about, and the same way back.
std::vector<Pose> there_and_back(const World& world, const Configuration& configuration, int seed,
                                 double length) {
  Tour tour(roomy_columns(world, configuration), static_cast<std::uint64_t>(seed));
  Pose pose = world.start;
  std::vector<Pose> poses = {pose};
  double driven = 0.0;
  const auto limit = static_cast<std::size_t>(20.0 * length / kPeriod);
  while (driven < length && poses.size() < limit) {
    const Twist twist = tour.command(pose);
    const double d = twist.linear.x() * kPeriod, yaw = pose.yaw + 0.5 * twist.yaw_rate * kPeriod;
    pose.position.x() += d * std::cos(yaw);
    pose.position.y() += d * std::sin(yaw);
    pose.yaw += twist.yaw_rate * kPeriod;
    driven += std::abs(d);
    poses.push_back(pose);
  }
  const std::vector<Pose> there = poses;
  constexpr int kTurnSteps = 50;
  for (int n = 1; n <= kTurnSteps; ++n) {
    pose.yaw = there.back().yaw + std::numbers::pi * n / kTurnSteps;
    poses.push_back(pose);
  }
  for (auto it = there.rbegin() + 1; it != there.rend(); ++it) {
    pose = *it;
    pose.yaw += std::numbers::pi;
    poses.push_back(pose);
  }
  return poses;
}

bool free_sight(const World& world, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const VoxelGrid::Ray ray = world.voxels.cast(a, b);
  return !ray.blocked && ray.unknown_length == 0.0;
}

double angle(const Eigen::Isometry3d& T) { return Eigen::AngleAxisd(T.linear()).angle(); }

struct Result {
  int views = 0, revisits = 0, recalled = 0, found = 0, used = 0, wrong = 0, by_looks = 0;
  double nees = 0.0, ate = 0.0, ate_with_loops = 0.0;
  double length = 0.0;
  int frames = 0, lost = 0;
  std::vector<double> ms;
};

Result judge(const World& world, const ViewLoops& loops,
             const std::vector<Eigen::Isometry3d>& truth, int newest) {
  Result r;
  r.views = loops.views();
  std::vector<char> known(truth.size(), 0);
  double squares = 0.0;
  for (std::size_t n = 0; n < loops.loops().size(); ++n) {
    const ViewLoops::Loop& loop = loops.loops()[n];
    ++r.found;
    if (loops.state(n) != LoopState::kUsed) continue;
    ++r.used;
    r.by_looks += loop.by_looks;
    const Eigen::Isometry3d apart = truth[static_cast<std::size_t>(loop.older)].inverse() *
                                    truth[static_cast<std::size_t>(loop.newer)];
    const Eigen::Isometry3d off = loop.alignment.measured.T.inverse() * apart;
    const Eigen::Matrix<double, 6, 1> e = log_se3(off);
    squares += e.dot(loop.alignment.measured.information * e) / 6.0;
    if (off.translation().norm() > kWrong || angle(off) > kWrongTurn) {
      ++r.wrong;
    } else {
      known[static_cast<std::size_t>(loop.newer)] = 1;
    }
  }
  r.nees = r.used > 0 ? squares / r.used : std::nan("");
  for (int k = 0; k < loops.views(); ++k) {
    const Eigen::Isometry3d& here = truth[static_cast<std::size_t>(k)];
    bool revisit = false;
    for (int older = 0; older < k - newest && !revisit; ++older) {
      const Eigen::Isometry3d& there = truth[static_cast<std::size_t>(older)];
      const Eigen::Isometry3d apart = there.inverse() * here;
      revisit = apart.translation().norm() <= kNear && angle(apart) <= kTurned &&
                free_sight(world, there.translation(), here.translation());
    }
    r.revisits += revisit;
    r.recalled += revisit && known[static_cast<std::size_t>(k)] != 0;
  }
  for (int k = 0; k < loops.views(); ++k) {
    const Eigen::Isometry3d& here = truth[static_cast<std::size_t>(k)];
    r.ate += (loops.measured(k).translation() - here.translation()).squaredNorm() / r.views;
    r.ate_with_loops += (loops.pose(k).translation() - here.translation()).squaredNorm() / r.views;
  }
  r.ate = std::sqrt(r.ate);
  r.ate_with_loops = std::sqrt(r.ate_with_loops);
  return r;
}

Result drive(const std::string& name, int seed, double length, double realism) {
  const Configuration configuration = configuration_from_text("", "the defaults", {}, {});
  const World world = load_world(name, world_options_for(configuration));
  const auto number = static_cast<std::uint64_t>(seed);
  WorldMeshOptions mesh_options;
  const FeatureField field(
      world, [&](int i, int j, int k) { return texture_density(world, i, j, k, number); }, number);
  SceneRendererOptions scene_options;
  const CameraEffects effects = scaled({}, realism);
  scene_options.floor_shine = effects.floor_shine;
  const auto scene = std::make_shared<const SceneRenderer>(
      world.mesh ? *world.mesh : world_mesh(world, field, mesh_options), scene_options);
  CameraRigOptions rig_options;
  rig_options.effects = effects;
  rig_options.seed = number;
  const CameraRig rig(scene, rig_options);
  ExposureControl control(effects.exposure_lag);

  const std::vector<Pose> poses = there_and_back(world, configuration, seed, length);
  // Where the camera is, not where the robot believes that it sits.
  const CameraMount mount = true_mount(rig.options().stereo_mount, effects,
                                       stream_seed(number, NoiseStream::kStereoMount));
  const auto camera_at = [&](const Pose& pose) { return body_transform(pose) * mount.T_BC; };
  const StereoCamera& camera = rig.options().stereo;
  StereoOdometryOptions odometry_options;
  ViewLoopsOptions options;
  if (realism > 0.0) {
    odometry_options.calibration = options.alignment.calibration = {
        effects.principal_point, effects.focal_length, effects.baseline};
  }
  StereoOdometry odometry(camera, odometry_options, camera_at(poses.front()));
  ViewLoops loops(camera, options);
  std::vector<Eigen::Isometry3d> truth;
  std::vector<double> ms;
  int lost = 0;
  for (std::size_t n = 0; n < poses.size(); ++n) {
    const double stamp = kPeriod * static_cast<double>(n);
    const double rate = n > 0 ? (poses[n].yaw - poses[n - 1].yaw) / kPeriod : 0.0;
    const ImagePair pair = rig.stereo(poses[n], {n, stamp, control.exposure(), rate}, {});
    control.measured(stamp, pair.left);
    const OdometryFrame frame = odometry.process(stamp, pair.left.view(), pair.right.view());
    lost += frame.state == Localization::kLost;
    if (!frame.keyframe || frame.state == Localization::kLost) continue;
    ProcessorStopwatch watch;
    loops.keyframe(frame, pair.left.view(), pair.right.view());
    const double lap = watch.lap();
    if (loops.views() == static_cast<int>(truth.size())) continue;
    truth.push_back(camera_at(poses[n]));
    ms.push_back(lap);
  }
  loops.settle();
  Result r = judge(world, loops, truth, options.newest);
  for (std::size_t n = 1; n < poses.size(); ++n) {
    r.length += (poses[n].position - poses[n - 1].position).norm();
  }
  r.ms = std::move(ms);
  r.frames = static_cast<int>(poses.size());
  r.lost = lost;
  return r;
}

int main_program(int argc, char** argv) {
  std::vector<std::string> worlds;
  int seed = 1;
  double length = 40.0, realism = 1.0;
  bool json = false;
  ProgramOptions options("Places that are known again by their looks, against the truth");
  options.add("--worlds", worlds, "as `prospect explore` takes them", {.commas = true});
  options.add("--seed", seed, "of tour and texture", {.least = 1, .most = 100000});
  options.add("--length", length, "of the tour, one way [m]", {.least = 5.0, .most = 1e4});
  options.add("--realism", realism, "as simulator.camera.realism", {.least = 0.0, .most = 3.0});
  options.add("--json", json, "rows as JSON");
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  if (worlds.empty()) worlds = {"office", "loop"};
  if (!json) {
    std::printf(
        "| world | way m | frames, lost | views | revisits, recalled | found, used, wrong | by "
        "looks | NEES | ATE "
        "m | with loops | ms p50, mean, p95 |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  }
  nlohmann::ordered_json rows;
  for (const std::string& world : worlds) {
    const Result r = drive(world, seed, length, realism);
    const double recall =
        r.revisits > 0 ? static_cast<double>(r.recalled) / r.revisits : std::nan("");
    const double p50 = quantile(r.ms, 0.5), p95 = quantile(r.ms, 0.95);
    const double mean = std::accumulate(r.ms.begin(), r.ms.end(), 0.0) /
                        static_cast<double>(std::max<std::size_t>(1, r.ms.size()));
    rows.push_back({{"world", world},
                    {"seed", seed},
                    {"length_m", r.length},
                    {"frames", r.frames},
                    {"lost", r.lost},
                    {"views", r.views},
                    {"revisits", r.revisits},
                    {"recall", recall},
                    {"found", r.found},
                    {"used", r.used},
                    {"wrong", r.wrong},
                    {"by_looks", r.by_looks},
                    {"nees", r.nees},
                    {"ate_m", r.ate},
                    {"ate_with_loops_m", r.ate_with_loops},
                    {"ms_p50", p50},
                    {"ms_mean", mean},
                    {"ms_p95", p95}});
    if (json) continue;
    std::printf(
        "| %s, %d | %.0f | %d, %d | %d | %d, %.0f %% | %d, %d, %d | %d | %.1f | %.3f | %.3f | "
        "%.1f, %.1f, %.1f "
        "|\n",
        world.c_str(), seed, r.length, r.frames, r.lost, r.views, r.revisits, 100.0 * recall,
        r.found, r.used, r.wrong, r.by_looks, r.nees, r.ate, r.ate_with_loops, p50, mean, p95);
    std::fflush(stdout);
  }
  if (json) std::cout << rows.dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("view_loops", prospect::main_program, argc, argv);
}
