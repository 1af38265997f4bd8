// odometry_table [STEREO]: the visual odometry over recordings, as a table in Markdown. STEREO is
// the folder that holds kitti_seq1, euroc_v101_start_static and tartan_hospital_a; without it only
// the rendered sequences (rendered_sequence.h) are run, 0 to 23 and 24 to 47, which count together
// each: medians of their errors, all their frames; with the calibration that made the images, by an
// odometry that takes it for a usual one and by one that is told that it is exact, and with one
// that is off by what the odometry's covariance allows it. NEES is the squared error over the
// claimed variance, a degree of freedom. Times are of the processor, all of a frame; all other
// numbers are the same for the same arguments.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "adapters/missions/recordings/odometry_run.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "benchmarks/rendered_sequence.h"
#include "engine/support/quantile.h"

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

void print_row(const std::string& name, const std::vector<OdometryRun>& runs,
               const ConsistencyResult& consistency) {
  std::vector<double> end, share, rpe;
  int ok = 0, degraded = 0, lost = 0, keyframes = 0;
  std::vector<double> times;
  for (const OdometryRun& run : runs) {
    const OdometrySummary s = summarize(run);
    end.push_back(1e3 * s.end.translation);
    // Of a camera that hardly moves a share says nothing.
    if (s.true_length > 0.1) share.push_back(100.0 * s.end.share);
    rpe.push_back(100.0 * s.rpe_1m.translation);
    ok += s.ok;
    degraded += s.degraded;
    lost += s.lost;
    keyframes += s.keyframes;
    for (const OdometryFrame& f : run.frames) times.push_back(f.times.processor);
  }
  const auto nees = [](const PoseConsistency& c) {
    return number(c.count > 0 ? c.mean : std::nan(""), "%.2f");
  };
  std::printf("| %s | %s mm, %s %% | %s %% | %s ", name.c_str(),
              number(median(end), "%.1f").c_str(), number(median(share), "%.2f").c_str(),
              number(median(rpe), "%.2f").c_str(), nees(consistency.pose).c_str());
  for (const ConsistencyResult::Motion& m : consistency.motions) {
    std::printf("| %s ", nees(m.consistency).c_str());
  }
  const TimePercentiles ms = percentiles(times);
  std::printf("| %d / %d / %d | %d | %.1f, %.1f |\n", ok, degraded, lost, keyframes, ms.p50,
              ms.p95);
  std::fflush(stdout);
}

void recording(const std::string& name, const std::string& path, int first) {
  const StereoDataset dataset = StereoDataset::open(path, {});
  std::vector<OdometryRun> runs;
  runs.push_back(run_odometry(dataset, {}, first));
  print_row(name, runs, runs.front().consistency);
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

/// Options of an odometry that is told that its calibration is exact. The disparities' zero, which
/// also takes up what images do to all disparities alike, is estimated all the same.
StereoOdometryOptions of_exact_calibration() {
  StereoOdometryOptions options;
  options.calibration = {0.0, 0.0, 0.0};
  return options;
}

void rendered(int first, int last) {
  constexpr int kFrames = 40;
  constexpr std::size_t kWays = 3;
  const StereoCamera camera = RenderedSequence::camera();
  OdometryConsistency consistency[kWays];
  std::vector<OdometryRun> runs[kWays];
  for (int s = first; s <= last; ++s) {
    const RenderedSequence sequence(s, kFrames);
    StereoOdometry odometry[kWays] = {
        StereoOdometry(camera, {}, sequence.path()[0]),
        StereoOdometry(camera, of_exact_calibration(), sequence.path()[0]),
        StereoOdometry(drawn_calibration(camera, s), {}, sequence.path()[0])};
    OdometryRun run[kWays];
    for (OdometryConsistency& c : consistency) c.begin_recording();
    for (int k = 0; k < kFrames; ++k) {
      const auto pair = sequence.render(camera, k);
      const double stamp = RenderedSequence::kPeriod * k;
      const Eigen::Isometry3d& truth = sequence.path()[static_cast<std::size_t>(k)];
      for (std::size_t c = 0; c < kWays; ++c) {
        run[c].frames.push_back(odometry[c].process(stamp, pair.left.view(), pair.right.view()));
        const OdometryFrame& frame = run[c].frames.back();
        consistency[c].add(odometry[c], frame, truth);
        if (frame.state == Localization::kLost) continue;
        run[c].trajectory.push_back({stamp, frame.T_WC});
        run[c].pairs.push_back({stamp, frame.T_WC, truth});
      }
    }
    for (std::size_t c = 0; c < kWays; ++c) runs[c].push_back(std::move(run[c]));
  }
  const std::string name = "rendered, " + std::to_string(first) + " to " + std::to_string(last);
  print_row(name, runs[0], consistency[0].result());
  print_row(name + ", calibration said to be exact", runs[1], consistency[1].result());
  print_row(name + ", calibration drawn", runs[2], consistency[2].result());
}

int main_program(int argc, char** argv) {
  std::string folder;
  ProgramOptions program("The visual odometry over recordings, as a table");
  program.add("stereo", folder, "Folder of the recordings");
  if (const auto end = program.parse(argc, argv)) return *end;
  std::printf(
      "| | end error | per 1 m | NEES: pose | 5 frames | 10 | 20 | ok / degraded / lost | "
      "keyframes "
      "| ms p50, p95 |\n|---|---|---|---|---|---|---|---|---|---|\n");
  if (!folder.empty()) {
    recording("KITTI clip", folder + "/kitti_seq1", 0);
    recording("KITTI clip from 12", folder + "/kitti_seq1", 12);
    recording("EuRoC at rest", folder + "/euroc_v101_start_static", 0);
    recording("TartanAir hospital", folder + "/tartan_hospital_a", 0);
  }
  rendered(0, 23);
  rendered(24, 47);
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("odometry_table", prospect::main_program, argc, argv);
}
