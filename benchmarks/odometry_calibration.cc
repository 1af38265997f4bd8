// SPDX-License-Identifier: Apache-2.0
// odometry_calibration [--first N] [--sequences N] [--frames N] [--width W] [--json]: what the
// planner predicts of landmarks and motion, against what the odometry tracked and measured, over
// rendered sequences (rendered_sequence.h). All sequences count together. Same arguments, same
// numbers.

#include "adapters/missions/recordings/odometry_calibration.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <vector>

#include "adapters/missions/recordings/calibration_report.h"
#include "benchmarks/program_options.h"
#include "benchmarks/rendered_sequence.h"
#include "perception/odometry/se3.h"

namespace prospect {
namespace {

int run(int first, int sequences, int frames, double width, bool json) {
  const StereoCamera camera = RenderedSequence::camera(width);
  OdometryCalibration calibration(camera, {});
  // Of the pose since the first, after so many frames.
  const std::vector<int> after = {1, 5, 10, 20, 39};
  std::vector<std::vector<double>> since_first(after.size());
  for (int s = first; s < first + sequences; ++s) {
    const RenderedSequence sequence(s, frames);
    const auto& path = sequence.path();
    StereoOdometry odometry(camera, {}, path[0]);
    calibration.begin_recording();
    for (int k = 0; k < frames; ++k) {
      const auto pair = sequence.render(camera, k);
      const OdometryFrame frame = odometry.process(0.1 * k, pair.left.view(), pair.right.view());
      calibration.add(odometry, frame, path[static_cast<std::size_t>(k)]);
      const auto at = std::find(after.begin(), after.end(), k);
      if (at == after.end() || frame.state == Localization::kLost) continue;
      since_first[static_cast<std::size_t>(at - after.begin())].push_back(normalised_error_squared(
          log_se3(frame.T_WC.inverse() * path[static_cast<std::size_t>(k)]), frame.covariance));
    }
    if (!json) std::fprintf(stderr, "\r%d of %d sequences", s + 1 - first, sequences);
  }
  if (!json) std::fputc('\n', stderr);
  const OdometryCalibrationResult result = calibration.result();
  if (json) {
    auto out = calibration_json(result);
    for (std::size_t i = 0; i < after.size(); ++i) {
      const PoseConsistency c = pose_consistency(since_first[i], 6);
      out["pose_consistency_after"].push_back({{"frames", after[i]},
                                               {"errors", c.count},
                                               {"mean", c.mean},
                                               {"median", c.median},
                                               {"within_95", c.within_95}});
    }
    std::cout << out.dump(2) << '\n';
    return 0;
  }
  std::fputs(calibration_text(result).c_str(), stdout);
  for (std::size_t i = 0; i < after.size(); ++i) {
    const PoseConsistency c = pose_consistency(since_first[i], 6);
    if (c.count == 0) continue;
    std::printf("  pose, after %2d frames  %6d  %7.2f %7.2f   %5.1f %%\n", after[i], c.count,
                c.mean, c.median, 100.0 * c.within_95);
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  prospect::ProgramOptions options(
      "The planner's predictions against the odometry, over rendered sequences");
  int first = 0, sequences = 24, frames = 40;
  double width = 480.0;
  bool json = false;
  options.add("--sequences", sequences, "how many", {.least = 1, .most = 10000});
  options.add("--first", first, "number of the first one", {.least = 0, .most = 1000000});
  options.add("--frames", frames, "of each", {.least = 2, .most = 10000});
  options.add("--width", width, "of the images [px]; the height is three quarters of it",
              {.least = 160.0, .most = 1920.0});
  options.add("--json", json, "print JSON");
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  return prospect::run(first, sequences, frames, 4.0 * std::round(width / 4.0), json);
}
