// SPDX-License-Identifier: Apache-2.0
// loop_alignments RUN [--seed S] [--loops FILE] [--json]: what is claimed of the loops of a map
// that is kept straight, against the truth. RUN: the folder of a mission of `prospect explore` in
// the fidelity `model`. Its true path is driven again, straight from step to step, by the same
// robot, whose odometry errs as drawn by the seed: nothing is planned, so the path does not depend
// on what is corrected. Each anchor's true pose is known, and so the error of each measurement
// between two:
//   e = log(measured^-1 true)   (x, y, yaw), in the frame of the newer one.
// Of odometry from anchor to anchor and of all loops that were found: the count, the mean of
// e^T C^-1 e / 3 (NEES) with the claimed covariance C, its median over the chi-square's, and the
// share beyond the chi-square's 99.9 %; then by direction, along the eigenvectors of C's position
// (along: the one that is claimed to be less sure, across) and in yaw: root mean square of e, that
// of its claimed deviation, and the mean of the squared ratio. Directions claimed to be less sure
// than 1 m or 0.5 rad count as not measured. Loops that the graph uses are counted by themselves.
// And the error of the robot's pose at each scan, as drawn and corrected [m].

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/replay/recorded_run.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/robots/simulator/feature_sensors.h"
#include "adapters/views/report/step_table.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "engine/support/quantile.h"
#include "engine/support/stopwatch.h"
#include "perception/mapping/anchored_map.h"
#include "perception/places/map_loops.h"

namespace prospect {
namespace {

struct Request {
  std::string run, loops;
  int seed = 1;
  bool json = false;
};

struct PathStep {
  double time = 0.0;
  Pose pose;
};

/// z [m]: of the robot's origin.
std::vector<PathStep> path_of(const std::string& folder, double z) {
  const std::string file = (std::filesystem::path(folder) / "steps.csv").string();
  const StepTable table = StepTable::read(file);
  const std::vector<double> time = table.numbers("time"), x = table.numbers("true_x"),
                            y = table.numbers("true_y"), yaw = table.numbers("true_yaw");
  std::vector<PathStep> path;
  for (std::size_t n = 0; n < table.rows(); ++n) {
    if (!std::isfinite(time[n] + x[n] + y[n] + yaw[n])) {
      fail(table.row_name(n), "no time or no true pose; expected numbers");
    }
    if (!path.empty() && time[n] <= path.back().time) {
      fail(table.row_name(n), "the time does not increase; expected one after another");
    }
    path.push_back({time[n], {{x[n], y[n], z}, yaw[n]}});
  }
  if (path.size() < 2) fail(file, "no path; expected two steps at least");
  return path;
}

/// Where it is at a time; `at` is the step before.
Pose pose_at(const std::vector<PathStep>& path, double time, std::size_t& at) {
  while (at + 2 < path.size() && path[at + 1].time <= time) ++at;
  const PathStep &a = path[at], &b = path[at + 1];
  const double share = std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0);
  return {a.pose.position + share * (b.pose.position - a.pose.position),
          a.pose.yaw + share * std::remainder(b.pose.yaw - a.pose.yaw, 2.0 * M_PI)};
}

/// Measurements of one kind.
class Consistency {
 public:
  void add(const Eigen::Vector3d& e, const Eigen::Matrix3d& C) {
    nees_.push_back(e.dot(C.ldlt().solve(e)));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(C.topLeftCorner<2, 2>());
    const Eigen::Vector2d own = eigen.eigenvectors().transpose() * e.head<2>();
    along_.add(own[1], eigen.eigenvalues()[1], 1.0);
    across_.add(own[0], eigen.eigenvalues()[0], 1.0);
    turn_.add(e[2], C(2, 2), 0.5);
  }
  void print(const char* name) const {
    constexpr double kMedian = 2.366, kOutside = 16.27;  // of chi-square, three degrees
    const double n = static_cast<double>(nees_.size());
    double sum = 0.0, outside = 0.0;
    for (const double x : nees_) sum += x, outside += x > kOutside;
    std::printf("\"%s\": {\"count\": %zu", name, nees_.size());
    if (!nees_.empty()) {
      std::printf(", \"nees\": %.2f, \"median_nees\": %.2f, \"outside\": %.3f, ", sum / (3.0 * n),
                  quantile(nees_, 0.5) / kMedian, outside / n);
      along_.print("along", 1e3);
      std::printf(", ");
      across_.print("across", 1e3);
      std::printf(", ");
      turn_.print("turn", 1e3);
    }
    std::printf("}");
  }

 private:
  struct Direction {
    int count = 0, unmeasured = 0;
    double e2 = 0.0, s2 = 0.0, ratio2 = 0.0;
    void add(double e, double variance, double most) {
      if (variance > most * most) {
        ++unmeasured;
        return;
      }
      ++count;
      e2 += e * e, s2 += variance, ratio2 += e * e / variance;
    }
    void print(const char* name, double scale) const {
      const double n = std::max(1, count);
      std::printf(
          "\"%s\": {\"count\": %d, \"not\": %d, \"rms\": %.2f, \"sigma\": %.2f, "
          "\"nees\": %.2f}",
          name, count, unmeasured, scale * std::sqrt(e2 / n), scale * std::sqrt(s2 / n),
          ratio2 / n);
    }
  };
  std::vector<double> nees_;
  Direction along_, across_, turn_;
};

Eigen::Vector3d error_of(const PlanarMove& measured, const PlanarMove& truth) {
  const PlanarMove e = measured.inverse() * truth;
  return {e.shift.x(), e.shift.y(), std::remainder(e.yaw, 2.0 * M_PI)};
}

PlanarMove place(const Pose& pose) { return {pose.position.head<2>(), pose.yaw}; }

/// Root of a mean of squares.
struct Mean {
  double sum = 0.0, last = 0.0;
  int count = 0;
  void add(double x) { sum += x * x, last = x, ++count; }
  double root() const { return std::sqrt(sum / std::max(1, count)); }
};

int main_program(int argc, char** argv) {
  Request request;
  ProgramOptions program("What is claimed of loops in a map, against the truth");
  program.add("run", request.run, "Folder of a mission", {.required = true});
  program.add("--seed", request.seed, "Of the odometry's errors", {.least = 0});
  program.add("--loops", request.loops, "Write a row a loop");
  program.add("--json", request.json, "Print one line for machines");
  if (const auto end = program.parse(argc, argv)) return *end;

  const RecordedRun run = read_recorded_run(request.run, {});
  const Configuration configuration =
      configuration_from_text(run.configuration, run.source, {}, {});
  const World world = load_world(run.world_source, world_options_for(configuration));
  SimulatorOptions options =
      simulator_options_for(configuration, static_cast<std::uint64_t>(request.seed));
  PerceptionOptions perception = configuration.perception;
  perception.loops = true;
  perception.mapping = mapping_options(options, perception.mapping);
  const std::vector<PathStep> path = path_of(request.run, options.base_height);
  const Pose start = path.front().pose;
  FeatureSensors sensors(world, options, perception, start, {});
  SeenArea seen(world, perception.mapping.slice);
  std::vector<Pose> truth;  // of each anchor's origin
  Mean drawn, corrected;
  std::size_t at = 0;
  ProcessorStopwatch clock;
  const auto note = [&](const Pose& pose) {
    while (truth.size() < sensors.straight_map()->anchored().anchors().size())
      truth.push_back(pose);
  };
  const double period = 1.0 / options.image_rate;
  const int images_a_scan = std::max(1, static_cast<int>(options.image_rate / options.depth_rate));
  sensors.scan(0.0, start, seen);
  note(start);
  sensors.image(0.0, start, {});
  for (int n = 1; n * period <= path.back().time; ++n) {
    const double t = n * period;
    const Pose pose = pose_at(path, t, at);
    sensors.image(t, pose, {});
    note(pose);
    if (n % images_a_scan != 0) continue;
    sensors.scan(t, pose, seen);
    note(pose);
    const Pose estimate = sensors.estimate(t, pose);
    drawn.add((estimate.position - pose.position).head<2>().norm());
    corrected.add((sensors.origin()(estimate).position - pose.position).head<2>().norm());
  }
  const double seconds = 1e-3 * clock.lap();

  Consistency steps, found, used, guesses;
  const std::vector<MapAnchor>& anchors = sensors.straight_map()->anchored().anchors();
  const MapLoops& loops = sensors.straight_map()->loops();
  const auto between = [&](int a, int b) {
    return place(truth[static_cast<std::size_t>(a)]).inverse() *
           place(truth[static_cast<std::size_t>(b)]);
  };
  for (const MapAnchor& to : anchors) {
    if (to.parent == to.id) continue;
    const AnchorStep step = step_between(anchors[static_cast<std::size_t>(to.parent)], to);
    steps.add(error_of(step.way, between(to.parent, to.id)), step.covariance);
  }
  std::ofstream table;
  if (!request.loops.empty()) {
    table.open(request.loops);
    table << "older,newer,used,e_x,e_y,e_yaw,s_x,s_y,s_yaw,nees,guess_x,guess_y,guess_yaw,g_x,g_y,"
             "g_yaw,overlap,agreement\n";
  }
  for (std::size_t n = 0; n < loops.loops().size(); ++n) {
    const MapLoops::Loop& loop = loops.loops()[n];
    const PlanarMove is = between(loop.older, loop.newer);
    const Eigen::Vector3d e = error_of(loop.measured.way, is), g = error_of(loop.expected.way, is);
    const bool in_use = loops.state(n) == LoopState::kUsed;
    found.add(e, loop.measured.covariance);
    guesses.add(g, loop.expected.covariance);
    if (in_use) used.add(e, loop.measured.covariance);
    if (!table.is_open()) continue;
    table << loop.older << ',' << loop.newer << ',' << in_use;
    for (int k = 0; k < 3; ++k) table << ',' << e[k];
    for (int k = 0; k < 3; ++k) table << ',' << std::sqrt(loop.measured.covariance(k, k));
    table << ',' << e.dot(loop.measured.covariance.ldlt().solve(e));
    for (int k = 0; k < 3; ++k) table << ',' << g[k];
    for (int k = 0; k < 3; ++k) table << ',' << std::sqrt(loop.expected.covariance(k, k));
    table << ',' << loop.overlap << ',' << loop.agreement << '\n';
  }
  const auto frame = sensors.belief(path.back().time, path.back().pose, {})->map_frame;
  std::printf("{\"anchors\": %zu, \"corrections\": %d, ", anchors.size(), frame ? frame->taken : 0);
  steps.print("steps");
  std::printf(", ");
  guesses.print("guesses");
  std::printf(", ");
  found.print("loops");
  std::printf(", ");
  used.print("used");
  std::printf(
      ", \"rms_drawn_m\": %.4f, \"rms_m\": %.4f, \"end_drawn_m\": %.4f, \"end_m\": %.4f, "
      "\"losses\": %d, \"seconds\": %.1f}\n",
      drawn.root(), corrected.root(), drawn.last, corrected.last, sensors.losses(), seconds);
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("loop_alignments", prospect::main_program, argc, argv);
}
