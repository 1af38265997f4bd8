// SPDX-License-Identifier: Apache-2.0
// odometry_out_of_step [CLIP...] [--rendered N] [--set KEY=VALUE...]: what the odometry says of how
// much later the right images are taken, where that is known, as a table in Markdown. CLIP is what
// `prospect odometry` reads; "CLIP@12" begins at frame 12. Its right images are taken from up to
// two frames before or after, and of every second and third frame of the left ones from between
// two. Then N rendered paths, of which every other one is in the hand and the others are a robot's
// in the plane, with the right images exactly so many milliseconds late.
//
// An answer is wrong if it is off by more than three of the deviations it states. Where the stamps
// are not regular, the truth is the mean.

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "adapters/formats/datasets/stereo_dataset.h"
#include "benchmarks/clip.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/odometry_settings.h"
#include "benchmarks/program_options.h"
#include "perception/odometry/se3.h"
#include "perception/odometry/stereo_odometry.h"
#include "tests/perception/rendered_room.h"

namespace prospect {
namespace {

struct Answers {
  int asked = 0, given = 0, wrong = 0;
};

/// Frames of a pair, and how much later the right one was taken [s].
struct LatePair {
  double stamp, late;
  Image left, right;
};

/// Runs the odometry over `frames` pairs and prints a row.
void answer(const std::string& name, const StereoCamera& camera,
            const StereoOdometryOptions& options, int frames,
            const std::function<LatePair(int)>& pair, Answers& answers) {
  StereoOdometry odometry(camera, options);
  OdometryFrame last;
  int count[3] = {0, 0, 0};
  double late = 0.0, processor = 0.0;
  for (int k = 0; k < frames; ++k) {
    const LatePair now = pair(k);
    last = odometry.process(now.stamp, now.left.view(), now.right.view());
    ++count[last.state == Localization::kOk ? 0 : last.state == Localization::kDegraded ? 1 : 2];
    late += now.late / frames;
    processor += last.times.processor / frames;
  }
  std::printf("| %s | %.1f ms ", name.c_str(), 1e3 * late);
  ++answers.asked;
  if (last.camera_time_offset_known) {
    const double off = std::abs(last.camera_time_offset - late) / last.camera_time_offset_sigma;
    ++answers.given;
    answers.wrong += off > 3.0;
    std::printf("| %.1f ± %.1f ms | %.1f%s ", 1e3 * last.camera_time_offset,
                1e3 * last.camera_time_offset_sigma, off, off > 3.0 ? " wrong" : "");
  } else {
    std::printf("| not known | ");
  }
  std::printf("| %d / %d / %d | %.1f | %s |\n", count[0], count[1], count[2], processor,
              last.out_of_step.c_str());
  std::fflush(stdout);
}

/// Every `step`-th left image, with the right one `shift` frames later.
void recording(const std::string& clip, const StereoOdometryOptions& options, Answers& answers) {
  const auto [path, name, first] = clip_of(clip);
  const StereoDataset dataset = StereoDataset::open(path, {});
  struct Way {
    int step, shift;
  };
  for (const Way way : {Way{1, 0}, Way{1, 1}, Way{1, -1}, Way{1, 2}, Way{1, -2}, Way{2, 0},
                        Way{2, 1}, Way{2, -1}, Way{3, 1}, Way{3, -1}}) {
    const int begin = first + std::max(0, -way.shift);
    const int frames = (dataset.size() - begin - std::max(0, way.shift) + way.step - 1) / way.step;
    if (frames < 2) continue;
    std::string called = name;
    if (way.step > 1) called += ", every " + std::to_string(way.step);
    called += ", " + std::to_string(way.shift);
    answer(
        called, dataset.camera(), options, frames,
        [&](int k) {
          const int left = begin + k * way.step, right = left + way.shift;
          StereoDataset::Pair pair = dataset.read(left);
          if (right != left) pair.right = dataset.read(right).right;
          return LatePair{dataset.stamp(left), dataset.stamp(right) - dataset.stamp(left),
                          std::move(pair.left), std::move(pair.right)};
        },
        answers);
  }
}

/// T_WC at a time [s], of a camera in a hand that goes ahead, or of a robot.
std::function<Eigen::Isometry3d(double)> path(int number) {
  std::mt19937 generator(static_cast<std::uint32_t>(number + 1));
  const auto between = [&](double low, double high) {
    return low + (high - low) * (generator() >> 8) / static_cast<double>(1 << 24);
  };
  const double x = between(-1.8, -1.2), y = between(-1.0, 1.0), yaw = between(-0.6, 0.6);
  const double forward = between(0.2, 0.6), turn = between(-0.3, 0.3);
  std::vector<double> size(6), rate(6), begin(6);
  for (int i = 0; i < 6; ++i) {
    size[i] = number % 2 == 0 ? between(0.01, 0.04) : 0.0;
    rate[i] = 2.0 * std::numbers::pi * between(0.5, 2.0);
    begin[i] = between(0.0, 6.28);
  }
  return [=](double t) {
    Eigen::Matrix<double, 6, 1> sway;
    for (int i = 0; i < 6; ++i) sway[i] = size[i] * std::sin(rate[i] * t + begin[i]);
    const Eigen::Isometry3d T_WC = test::RenderedRoom::looking(
        x + forward * t * std::cos(yaw), y + forward * t * std::sin(yaw), 1.05, yaw + turn * t);
    return Eigen::Isometry3d(T_WC * exp_se3(sway));
  };
}

void rendered(int number, const StereoOdometryOptions& options, Answers& answers) {
  constexpr double kPeriod = 0.05;
  constexpr int kFrames = 60;
  StereoCamera camera;
  camera.left = {330.0, 330.0, 240.0, 180.0, 480.0, 360.0};
  const test::RenderedRoom room;
  const auto T_WC = path(number);
  for (const double late : {0.0, 0.01, -0.01, 0.02, -0.02, 0.05, -0.05, 0.1, -0.1}) {
    answer(
        (number % 2 == 0 ? "rendered, in the hand " : "rendered, robot ") + std::to_string(number),
        camera, options, kFrames,
        [&](int k) {
          const double t = kPeriod * k;
          Eigen::Isometry3d right = T_WC(t + late);
          right.translation() += camera.baseline * right.linear().col(0);
          const auto seed = static_cast<std::uint64_t>(1000 * number + 2 * k);
          return LatePair{t, late, room.render(camera.left, T_WC(t), 2.0, seed),
                          room.render(camera.left, right, 2.0, seed + 1)};
        },
        answers);
  }
}

int main_program(int argc, char** argv) {
  std::vector<std::string> clips, settings;
  int paths = 4;
  ProgramOptions program("What the odometry says of right images that are late");
  program.add("clips", clips, "Recordings; PATH@12 begins at frame 12");
  program.add("--rendered", paths, "Rendered paths", {.least = 0, .most = 100});
  program.add("--set", settings, "Of perception.odometry, such as time_offset.trust=0.2");
  if (const auto end = program.parse(argc, argv)) return *end;
  const StereoOdometryOptions options = odometry_with(settings);
  std::printf(
      "| clip, frames later | late | found | deviations off | ok / degraded / lost | ms a frame | "
      "out of step |\n|---|---|---|---|---|---|---|\n");
  Answers answers;
  for (const std::string& clip : clips) recording(clip, options, answers);
  for (int n = 0; n < paths; ++n) rendered(n, options, answers);
  std::printf("\n%d of %d answered, %d wrong\n", answers.given, answers.asked, answers.wrong);
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("odometry_out_of_step", prospect::main_program, argc, argv);
}
