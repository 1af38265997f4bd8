// SPDX-License-Identifier: Apache-2.0
// Writes a report of a synthetic run, and beside it where the robot is at some steps, for
// report_test.sh to compare with what a browser draws.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>

#include "adapters/views/report/report.h"
#include "engine/support/named.h"
#include "tests/adapters/synthetic_run.h"

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    std::fprintf(stderr,
                 "usage: write_sample_report FOLDER [STEPS [bare]]\n"
                 "bare: as a program records that knows no modes, targets and candidates\n");
    return 2;
  }
  const std::string folder = argv[1];
  const int n = argc >= 3 ? std::stoi(argv[2]) : 240;
  prospect::RunRecord run = prospect::synthetic_run(n);
  if (argc == 4) {
    for (prospect::StepRecord& s : run.steps) {
      s.mode.reset();
      s.cause.reset();
      s.safety_level.reset();
      s.target_change.reset();
      s.why.clear();
      s.target.reset();
      s.candidates.clear();
      s.standings.clear();
      s.cost_to_go.reset();
      s.seeds_scored = 0;
    }
  }
  std::ofstream(folder + "/report.html") << prospect::render_report(run);

  // The steps that the page's self-test visits, in its order.
  std::ofstream expected(folder + "/expected.txt");
  for (const int k : {0, n / 3, 2 * n / 3, n - 1, n / 2, 0}) {
    std::size_t known = 0;
    {
      std::set<std::pair<int, int>> cells;
      for (int i = 0; i <= k; ++i) {
        for (const auto& [cell, state] : run.steps[i].map_changes) cells.emplace(cell.i, cell.j);
      }
      known = cells.size();
    }
    const prospect::StepRecord& s = run.steps[k];
    const int picture = k - k % prospect::kPictureEvery;
    char line[256];
    std::snprintf(line, sizeof line,
                  "step %d robot %.3f %.3f known %zu frontiers %zu landmarks %zu horizon %zu "
                  "clock %.1f image %d tracked %d",
                  k, static_cast<double>(static_cast<float>(s.estimated_pose.position.x())),
                  static_cast<double>(static_cast<float>(s.estimated_pose.position.y())), known,
                  s.frontier_cells.size(), s.landmarks.size(), s.horizon.size(), s.time, picture,
                  picture / 20 + 1);
    expected << line << '\n';
    expected << "why " << k << ' ' << prospect::name_of(s.mode) << ": " << s.why << '\n';
    char target[32] = "none";
    if (s.target) std::snprintf(target, sizeof target, "%.2f", s.target->path_left);
    const auto executed = std::count_if(
        s.candidates.begin(), s.candidates.end(), [](const prospect::CandidateRecord& c) {
          return c.verdict.kind == prospect::Verdict::Kind::kExecuted;
        });
    expected << "seen at " << k << ": target " << target << " candidates " << s.candidates.size()
             << " executed " << executed << '\n';
  }
  expected << "plots 10\n";
  expected << "strip look around: start\n";
  expected.close();
  return expected ? 0 : 1;
}
