// SPDX-License-Identifier: Apache-2.0
// odometry_peers CLIP... [--poses NAME=FOLDER]...: the visual odometry and what other programs made
// of the same recordings, as a table in Markdown, the worst end error first. FOLDER holds CLIP.txt,
// poses in KITTI's form, a line a pair of CLIP, in a frame of their own; CLIP is what `prospect
// odometry` reads, "CLIP@12" begins at frame 12 of both. First poses aligned, no loop closing.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/stereo_dataset.h"
#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/missions/recordings/odometry_run.h"
#include "adapters/missions/recordings/trajectory_error.h"
#include "benchmarks/clip.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "models/knobs.h"

namespace prospect {
namespace {

struct Row {
  std::string clip, program, times;
  EndError end;
  RelativeError per_1m, per_10m;
};

Row measured(const std::string& clip, const std::string& program,
             const std::vector<PosePair>& pairs) {
  return {
      clip, program, "", end_error(pairs), relative_error(pairs, 1.0), relative_error(pairs, 10.0)};
}

/// The poses of another program, from frame `first` on, with the true ones.
std::vector<PosePair> poses_of(const std::string& file, const StereoDataset& dataset, int first) {
  std::vector<std::string> notes;
  const std::vector<Eigen::Isometry3d> poses = read_kitti_poses(file, notes);
  if (static_cast<int>(poses.size()) != dataset.size()) {
    throw InputError(file + ": holds " + std::to_string(poses.size()) + " poses, the recording " +
                     std::to_string(dataset.size()) + " pairs; expected a pose a pair");
  }
  Trajectory trajectory;
  for (int i = first; i < dataset.size(); ++i) {
    trajectory.push_back({dataset.stamp(i), poses[static_cast<std::size_t>(i)]});
  }
  return associate(trajectory, dataset.ground_truth());
}

std::string percent(const RelativeError& e) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f %%", 100.0 * e.translation);
  return e.segments > 0 ? text : "-";
}

int main_program(int argc, char** argv) {
  std::vector<std::string> clips, others;
  ProgramOptions program("The visual odometry beside poses that other programs found");
  program.add("clips", clips, "Recordings; PATH@12 begins at frame 12");
  program.add("--poses", others, "NAME=FOLDER of another program, with CLIP.txt in KITTI's form");
  if (const auto end = program.parse(argc, argv)) return *end;
  std::vector<Row> rows;
  for (const std::string& clip : clips) {
    const auto [path, stem, first] = clip_of(clip);
    const std::string name = first > 0 ? stem + " from " + std::to_string(first) : stem;
    const StereoDataset dataset = StereoDataset::open(path, {});
    const OdometryRun run = run_odometry(dataset, {}, first);
    rows.push_back(measured(name, "here", run.pairs));
    std::vector<double> times;
    for (const OdometryFrame& f : run.frames) times.push_back(f.times.processor);
    const TimePercentiles ms = percentiles(times);
    char text[64];
    std::snprintf(text, sizeof text, "%.1f, %.1f", ms.p50, ms.p95);
    rows.back().times = text;
    for (const std::string& other : others) {
      const std::size_t equal = other.find('=');
      if (equal == std::string::npos) throw InputError(other + ": expected NAME=FOLDER");
      const std::string file = other.substr(equal + 1) + "/" + stem + ".txt";
      if (!std::filesystem::exists(file)) continue;
      rows.push_back(measured(name, other.substr(0, equal), poses_of(file, dataset, first)));
    }
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.end.share > b.end.share; });
  std::printf(
      "| clip | | end error | turn | per 1 m | per 10 m | processor ms: p50, p95 |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const Row& r : rows) {
    std::printf("| %s | %s | %.1f mm, %.2f %% | %.2f | %s | %s | %s |\n", r.clip.c_str(),
                r.program.c_str(), 1e3 * r.end.translation, 100.0 * r.end.share,
                r.end.rotation / kRadiansPerDegree, percent(r.per_1m).c_str(),
                percent(r.per_10m).c_str(), r.times.c_str());
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("odometry_peers", prospect::main_program, argc, argv);
}
