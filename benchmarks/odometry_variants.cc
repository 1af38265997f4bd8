// SPDX-License-Identifier: Apache-2.0
// odometry_variants FOLDER... [--frames FILE]: the visual odometry over all
// recordings in each folder, such as one recording broken in many ways, as a table in Markdown, the
// worst first: by frames that are wrong though ok (wrong_frames.h), then by how far the claim is
// exceeded. Error and claim are of the position at the newest frame that has a pose. Of the
// degraded frames and of the ok ones: by how many of the sigmas claimed 95 % of them are off at
// most, and all of them (claim_ratios.h), of position, rotation and both. A recording that is
// refused says why, one that ends with exit code 2 of `prospect odometry` says "refused at the
// end". --frames writes each frame as a row of FILE.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <tuple>
#include <vector>

#include "adapters/formats/datasets/stereo_dataset.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/missions/recordings/odometry_run.h"
#include "benchmarks/claim_ratios.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "benchmarks/wrong_frames.h"

namespace prospect {
namespace {

struct Row {
  std::string name, remark;
  OdometrySummary summary;
  WrongFrames wrong;
  ClaimRatios ok, degraded;
  double error = std::nan(""), claimed = std::nan("");  // [m]
};

void write_frame(std::ofstream& file, const std::string& recording, int number,
                 const OdometryFrame& frame, const Eigen::Isometry3d& truth) {
  const Eigen::Isometry3d off = frame.T_WC.inverse() * truth;
  const ClaimRatios::Ratios ratios = ClaimRatios::of(frame, truth);
  file << recording << ',' << number << ',' << to_string(frame.state) << ','
       << off.translation().norm() << ',' << Eigen::AngleAxisd(off.linear()).angle() << ','
       << ratios.position << ',' << ratios.rotation << ',' << ratios.both << ',' << frame.tracked
       << ',' << frame.confirmed << ',' << frame.expected << ',' << frame.chi2_per_dof << ','
       << frame.keyframe_reason << ',' << frame.reason << '\n';
}

/// "95 %, all" of the position, of the rotation, of both.
std::string sigmas(const ClaimRatios& claims) {
  if (claims.empty()) return "-";
  const ClaimRatios::Ratios most = claims.quantiles(0.95), all = claims.quantiles(1.0);
  char text[96];
  std::snprintf(text, sizeof text, "%.1f, %.1f; %.1f, %.1f; %.1f, %.1f", most.position,
                all.position, most.rotation, all.rotation, most.both, all.both);
  return text;
}

Row row_of(const std::string& path, std::ofstream& file) {
  Row row;
  row.name = std::filesystem::path(path).filename().string();
  try {
    const StereoDataset dataset = StereoDataset::open(path, {});
    const OdometryRun run = run_odometry(dataset, {}, 0, 0, [&](const OdometryStep& step) {
      if (!step.true_T_WC) return;
      if (file.is_open()) write_frame(file, path, step.done - 1, step.frame, *step.true_T_WC);
      row.wrong.add(step.frame, *step.true_T_WC);
      if (step.frame.state == Localization::kLost) return;
      (step.frame.state == Localization::kOk ? row.ok : row.degraded)
          .add(ClaimRatios::of(step.frame, *step.true_T_WC));
      row.error = (step.frame.T_WC.translation() - step.true_T_WC->translation()).norm();
      row.claimed = std::sqrt(step.frame.covariance.topLeftCorner<3, 3>().trace());
    });
    row.summary = summarize(run);
    if (!row.summary.out_of_step.empty()) row.remark = "out of step";
    if (row.summary.scale.verdict == ScaleAgreement::Verdict::kDisagree) {
      row.remark += std::string(row.remark.empty() ? "" : "; ") + "refused at the end";
    }
  } catch (const InputError& error) {
    row.remark = "refused: " + error.lines()[0].substr(error.lines()[0].rfind(": ") + 2);
  }
  return row;
}

int main_program(int argc, char** argv) {
  std::vector<std::string> folders;
  std::string frames;
  ProgramOptions program("The visual odometry over all recordings in folders, worst first");
  program.add("folders", folders, "Folders of recordings");
  program.add("--frames", frames, "File for a row of each frame");
  if (const auto end = program.parse(argc, argv)) return *end;
  std::ofstream file;
  if (!frames.empty()) {
    file.open(frames);
    file << "recording,frame,state,off,turned,position,rotation,both,tracked,confirmed,expected,"
            "chi2,keyframe,reason\n";
  }
  for (const std::string& folder : folders) {
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.is_directory()) paths.push_back(entry.path().string());
    }
    std::sort(paths.begin(), paths.end());
    std::vector<Row> rows;
    for (const std::string& path : paths) rows.push_back(row_of(path, file));
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
      return std::tuple(a.wrong.ok, a.wrong.worst) > std::tuple(b.wrong.ok, b.wrong.worst);
    });
    int wrong = 0;
    std::printf(
        "| %s | ok / degraded / lost | error, claimed [m] | wrong: ok, others "
        "| degraded: sigmas | ok: sigmas | |\n"
        "|---|---|---|---|---|---|---|\n",
        std::filesystem::path(folder).filename().string().c_str());
    for (const Row& r : rows) {
      wrong += r.wrong.ok;
      std::printf("| %s | %d / %d / %d | %.3f, %.3f | %d, %d | %s | %s | %s |\n", r.name.c_str(),
                  r.summary.ok, r.summary.degraded, r.summary.lost, r.error, r.claimed, r.wrong.ok,
                  r.wrong.other, sigmas(r.degraded).c_str(), sigmas(r.ok).c_str(),
                  r.remark.c_str());
    }
    std::printf("wrong though ok: %d frames of %zu recordings\n\n", wrong, rows.size());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("odometry_variants", prospect::main_program, argc, argv);
}
