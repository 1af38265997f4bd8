// SPDX-License-Identifier: Apache-2.0
// odometry_variants FOLDER...: the visual odometry over all recordings in each
// folder, such as one recording broken in many ways, as a table in Markdown, the worst first: by
// frames that are wrong though ok (wrong_frames.h), then by how far the claim is exceeded. Error
// and claim are of the position at the newest frame that has a pose; a recording that is refused
// says why, one that ends with exit code 2 of `prospect odometry` says "refused at the end".

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "adapters/formats/datasets/stereo_dataset.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/missions/recordings/odometry_run.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "benchmarks/wrong_frames.h"

namespace prospect {
namespace {

struct Row {
  std::string name, remark;
  OdometrySummary summary;
  WrongFrames wrong;
  double error = std::nan(""), claimed = std::nan("");  // [m]
};

Row row_of(const std::string& path) {
  Row row;
  row.name = std::filesystem::path(path).filename().string();
  try {
    const StereoDataset dataset = StereoDataset::open(path, {});
    const OdometryRun run = run_odometry(dataset, {}, 0, 0, [&](const OdometryStep& step) {
      if (!step.true_T_WC) return;
      row.wrong.add(step.frame, *step.true_T_WC);
      if (step.frame.state == Localization::kLost) return;
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
  ProgramOptions program("The visual odometry over all recordings in folders, worst first");
  program.add("folders", folders, "Folders of recordings");
  if (const auto end = program.parse(argc, argv)) return *end;
  for (const std::string& folder : folders) {
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.is_directory()) paths.push_back(entry.path().string());
    }
    std::sort(paths.begin(), paths.end());
    std::vector<Row> rows;
    for (const std::string& path : paths) rows.push_back(row_of(path));
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
      return std::tuple(a.wrong.ok, a.wrong.worst) > std::tuple(b.wrong.ok, b.wrong.worst);
    });
    int wrong = 0;
    std::printf(
        "| %s | ok / degraded / lost | error, claimed [m] | wrong: ok, others | |\n"
        "|---|---|---|---|---|\n",
        std::filesystem::path(folder).filename().string().c_str());
    for (const Row& r : rows) {
      wrong += r.wrong.ok;
      std::printf("| %s | %d / %d / %d | %.3f, %.3f | %d, %d | %s |\n", r.name.c_str(),
                  r.summary.ok, r.summary.degraded, r.summary.lost, r.error, r.claimed, r.wrong.ok,
                  r.wrong.other, r.remark.c_str());
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
