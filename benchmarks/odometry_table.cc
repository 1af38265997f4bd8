// SPDX-License-Identifier: Apache-2.0
// odometry_table [CLIP...] [--pieces N] [--sequences N] [--realism X] [--set KEY=VALUE...]: the
// visual odometry over recordings, as a table in Markdown. CLIP is what `prospect odometry` reads;
// "CLIP@12" begins at frame 12. With --pieces, each is also run in so many pieces that overlap by
// half, each by an odometry of its own. Then rendered sequences (rendered_sequence.h), which count
// together: medians of their errors, all their frames; with the calibration that made the images,
// by an odometry that takes it for a usual one and by one that is told that it is exact, and with
// one that is off by what the odometry's covariance allows it; with --realism besides by the
// simulator's cameras (real_cameras.h), which the odometry believes to be others.
//
// NEES is the squared error over the claimed variance, a degree of freedom: 1 if true. Of the pose
// against the first, and of the motion over 5, 10 and 20 frames; of the latter also by the planner
// (OdometryCalibration). A frame is wrong if its position is off by more than 5 cm and by more than
// four of the standard deviations claimed, the root of the trace; the last column counts those that
// are ok, and those that are not, with the largest ratio of error to claim where the error is over
// 5 cm. Where the truth is bad, so are these numbers. Times are of the processor, all of a frame;
// all other numbers are the same for the same arguments.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "adapters/missions/recordings/odometry_calibration.h"
#include "adapters/missions/recordings/odometry_run.h"
#include "benchmarks/clip.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/odometry_settings.h"
#include "benchmarks/program_options.h"
#include "benchmarks/real_cameras.h"
#include "benchmarks/rendered_sequence.h"
#include "benchmarks/wrong_frames.h"
#include "engine/support/quantile.h"
#include "models/knobs.h"

namespace prospect {
namespace {

/// Median of what is finite.
double median(std::vector<double> values) {
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  return values.empty() ? std::nan("") : quantile(values, 0.5);
}

std::string number(double value, const char* format) {
  if (!std::isfinite(value)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

struct Consistency {
  ConsistencyResult own;
  std::vector<PoseConsistency> planner;
};

void print_row(const std::string& name, const std::vector<OdometryRun>& runs,
               const Consistency& consistency, const WrongFrames& wrong) {
  std::vector<double> end, share, turn;
  int ok = 0, degraded = 0, lost = 0, keyframes = 0;
  std::vector<double> times;
  for (const OdometryRun& run : runs) {
    const OdometrySummary s = summarize(run);
    end.push_back(1e3 * s.end.translation);
    // Of a camera that hardly moves a share says nothing.
    if (s.true_length > 0.1) share.push_back(100.0 * s.end.share);
    turn.push_back(s.end.rotation / kRadiansPerDegree);
    ok += s.ok;
    degraded += s.degraded;
    lost += s.lost;
    keyframes += s.keyframes;
    for (const OdometryFrame& f : run.frames) times.push_back(f.times.processor);
  }
  const auto nees = [](const PoseConsistency& c) {
    return number(c.count > 0 ? c.mean : std::nan(""), "%.2f");
  };
  std::printf("| %s | %s mm, %s %%, %s | %s ", name.c_str(), number(median(end), "%.1f").c_str(),
              number(median(share), "%.2f").c_str(), number(median(turn), "%.2f").c_str(),
              nees(consistency.own.pose).c_str());
  for (const ConsistencyResult::Motion& m : consistency.own.motions) {
    std::printf("| %s ", nees(m.consistency).c_str());
  }
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf("%s%s", i == 0 ? "| " : ", ",
                i < consistency.planner.size() ? nees(consistency.planner[i]).c_str() : "-");
  }
  const TimePercentiles ms = percentiles(times);
  std::printf(" | %d / %d / %d | %d | %.1f, %.1f | %d, %d (%.1f) |\n", ok, degraded, lost,
              keyframes, ms.p50, ms.p95, wrong.ok, wrong.other, wrong.worst);
  std::fflush(stdout);
}

void recording(const std::string& name, const StereoDataset& dataset,
               const StereoOdometryOptions& options, int first, int frames) {
  OdometryCalibration calibration(dataset.camera(), options);
  WrongFrames wrong;
  std::vector<OdometryRun> runs;
  runs.push_back(run_odometry(dataset, options, first, frames, [&](const OdometryStep& step) {
    calibration.add(step.odometry, step.frame, step.true_T_WC);
    if (step.true_T_WC) wrong.add(step.frame, *step.true_T_WC);
  }));
  print_row(name, runs, {runs.front().consistency, calibration.result().motion}, wrong);
}

/// A recording as "PATH" or "PATH@FIRST", all of it and in pieces that overlap by half.
void recordings(const std::string& clip, const StereoOdometryOptions& options, int pieces) {
  const Clip told = clip_of(clip);
  const std::string& name = told.name;
  const int first = told.first;
  const StereoDataset dataset = StereoDataset::open(told.path, {});
  const int frames = std::max(0, dataset.size() - first);
  const auto called = [&](int from) {
    return from == 0 ? name : name + " from " + std::to_string(from);
  };
  recording(called(first), dataset, options, first, frames);
  if (pieces < 2) return;
  // n pieces of length l that overlap by half cover (n + 1) l / 2.
  const int half = frames / (pieces + 1);
  for (int i = 0; i < pieces; ++i) {
    recording(called(first + i * half) + ", " + std::to_string(2 * half), dataset, options,
              first + i * half, 2 * half);
  }
}

/// A calibration of this camera that is off by what its covariance says: drawn for the sequence.
StereoCamera drawn_calibration(StereoCamera camera, int number) {
  std::mt19937 generator(static_cast<std::uint32_t>(100 + number));
  // Nearly Gaussian, the same with every library.
  const auto normal = [&] {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += generator() / 4294967296.0;
    return sum;
  };
  const CalibrationErrorOptions off;
  camera.left.cx += off.principal_point * normal();
  camera.left.cy += off.principal_point * normal();
  const double focal = 1.0 + off.focal_length * normal();
  camera.left.fx *= focal;
  camera.left.fy *= focal;
  camera.baseline *= 1.0 + off.baseline * normal();
  return camera;
}

/// Sequences 0 to `sequences` - 1.
void rendered(const StereoOdometryOptions& options, int sequences, double realism) {
  constexpr int kFrames = 40;
  const StereoCamera camera = RenderedSequence::camera();
  // The disparities' zero, which also takes up what images do to all disparities alike, is
  // estimated all the same.
  StereoOdometryOptions exact = options;
  exact.calibration = {0.0, 0.0, 0.0};
  struct Way {
    std::string name;
    StereoOdometryOptions options;
    bool drawn = false;
    bool real = false;
    OdometryConsistency consistency = {};
    OdometryCalibration calibration = {RenderedSequence::camera(), {}};
    WrongFrames wrong = {};
    std::vector<OdometryRun> runs = {};
  };
  std::vector<Way> ways = {
      {"rendered", options},
      {"rendered, calibration said to be exact", exact},
      {.name = "rendered, calibration drawn", .options = options, .drawn = true}};
  if (realism > 0.0) {
    ways.push_back(
        {.name = "rendered, realism " + number(realism, "%g"), .options = options, .real = true});
  }
  for (int s = 0; s < sequences; ++s) {
    const RenderedSequence sequence(s, kFrames);
    RealCameras cameras(sequence, camera, realism);
    std::vector<StereoOdometry> odometry;
    for (Way& way : ways) {
      odometry.emplace_back(way.drawn ? drawn_calibration(camera, s) : camera, way.options,
                            sequence.path()[0]);
      way.consistency.begin_recording();
      way.calibration.begin_recording();
      way.runs.emplace_back();
    }
    for (int k = 0; k < kFrames; ++k) {
      const auto pair = sequence.render(camera, k);
      const ImagePair real = realism > 0.0 ? cameras.render(k) : ImagePair();
      const double stamp = RenderedSequence::kPeriod * k;
      const Eigen::Isometry3d& truth = sequence.path()[static_cast<std::size_t>(k)];
      for (std::size_t w = 0; w < ways.size(); ++w) {
        OdometryRun& run = ways[w].runs.back();
        run.frames.push_back(ways[w].real
                                 ? odometry[w].process(stamp, real.left.view(), real.right.view())
                                 : odometry[w].process(stamp, pair.left.view(), pair.right.view()));
        const OdometryFrame& frame = run.frames.back();
        ways[w].consistency.add(odometry[w], frame, truth);
        ways[w].calibration.add(odometry[w], frame, truth);
        ways[w].wrong.add(frame, truth);
        if (frame.state == Localization::kLost) continue;
        run.trajectory.push_back({stamp, frame.T_WC});
        run.pairs.push_back({stamp, frame.T_WC, truth});
      }
    }
  }
  for (const Way& way : ways) {
    print_row(way.name, way.runs, {way.consistency.result(), way.calibration.result().motion},
              way.wrong);
  }
}

int main_program(int argc, char** argv) {
  std::vector<std::string> clips, settings;
  int pieces = 0, sequences = 24;
  double realism = 0.0;
  ProgramOptions program("The visual odometry over recordings, as a table");
  program.add("clips", clips, "Recordings; PATH@12 begins at frame 12");
  program.add("--pieces", pieces, "Run each recording in so many pieces, too",
              {.least = 0, .most = 100});
  program.add("--sequences", sequences, "Rendered sequences", {.least = 0, .most = 1000});
  program.add("--realism", realism, "Of the sequences, as simulator.camera.realism",
              {.least = 0.0, .most = 3.0});
  program.add("--set", settings, "Of perception.odometry, such as pose.huber=2");
  if (const auto end = program.parse(argc, argv)) return *end;
  const StereoOdometryOptions options = odometry_with(settings);
  std::printf(
      "| | end error, deg | NEES: pose | 5 frames | 10 | 20 | planner 5, 10, 20 | ok / degraded / "
      "lost | keyframes | ms p50, p95 | wrong ok, others (worst) |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& clip : clips) recordings(clip, options, pieces);
  if (sequences > 0) rendered(options, sequences, realism);
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("odometry_table", prospect::main_program, argc, argv);
}
