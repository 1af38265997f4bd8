// SPDX-License-Identifier: Apache-2.0
// path_integral_cost: processor time of sampling:mppi for each stage of each rollout, in
// nanoseconds, of whole solves (the noise is drawn once a solve; the solver's own work is in it):
// on R1 over the number of samples an iteration, on the planner's problem over samples, stages and
// landmarks. Of each the least of several solves. "values": the same solve with every cost in
// double precision. Then how it grows with threads: 1, 2 and 4 in turn, processor time of all and
// of the caller, which a solve takes at least, and the least by the clock.

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "problems/r1.h"
#include "solvers/registry.h"
#include "tests/engine/planning_scene.h"

namespace prospect {
namespace {

/// The same cost, without scores.
class ValueOnly final : public Term {
 public:
  explicit ValueOnly(std::shared_ptr<const Term> term) : term_(std::move(term)) {}
  std::string_view name() const override { return term_->name(); }
  TermTraits traits() const override {
    TermTraits traits = term_->traits();
    traits.scores = false;
    return traits;
  }
  int rows(const Horizon& horizon) const override { return term_->rows(horizon); }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon& horizon) const override {
    return term_->jacobian_pattern(horizon);
  }
  std::unique_ptr<TermScratch> make_scratch(const Horizon& horizon, int batch) const override {
    return term_->make_scratch(horizon, batch);
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch* scratch,
                TermOutput& out) const override {
    term_->evaluate(t, request, scratch, out);
  }

 private:
  std::shared_ptr<const Term> term_;
};

double processor_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double nanoseconds(const Problem& problem, int samples, int evaluations) {
  const auto solver = make_solver("sampling:mppi");
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    const double begin = processor_seconds();
    const Result r =
        solver->solve(problem, {}, {{"samples", samples}, {"max_evaluations", evaluations}}, {});
    const double seconds = processor_seconds() - begin;
    least = std::min(least, seconds / r.counters.cost_evaluations);
  }
  return 1e9 * least / problem.definition().N;
}

void report(const std::string& what, const Problem& problem, int samples, int evaluations) {
  ProblemDefinition values = problem.definition();
  for (auto& weighted : values.terms) weighted.term = std::make_shared<ValueOnly>(weighted.term);
  const double scored = nanoseconds(problem, samples, evaluations);
  const double exact = nanoseconds(Problem(values), samples, evaluations);
  std::printf("| %-40s | %7.0f | %7.0f | %.2f |\n", what.c_str(), scored, exact, exact / scored);
}

void planner(const std::string& what, int samples, int N, int landmarks) {
  PlannerParameters parameters;
  parameters.N = N;
  parameters.dt = 5.0 / N;
  parameters.max_landmarks = landmarks;
  const test::PlanningScene scene("unicycle_accel", parameters, landmarks + landmarks / 3);
  report(what, *scene.problem, samples, 1000);
}

double process_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void threads(const std::string& what, const Problem& problem, int evaluations) {
  const auto solver = make_solver("sampling:mppi");
  constexpr int kThreads[] = {1, 2, 4}, kSolves = 30;
  double clock[] = {1e30, 1e30, 1e30}, all[3] = {}, callers[3] = {};
  for (int i = 0; i < kSolves; ++i) {
    for (int t = 0; t < 3; ++t) {
      const double process = process_seconds(), caller = processor_seconds();
      const Result r = solver->solve(
          problem, {},
          {{"samples", 128}, {"max_evaluations", evaluations}, {"threads", kThreads[t]}}, {});
      all[t] += 1e3 / kSolves * (process_seconds() - process);
      callers[t] += 1e3 / kSolves * (processor_seconds() - caller);
      clock[t] = std::min(clock[t], 1e3 * r.seconds);
    }
  }
  for (int t = 0; t < 3; ++t) {
    std::printf("| %-40s | %d | %7.1f | %7.1f | %.0f %% | %7.1f |\n", what.c_str(), kThreads[t],
                all[t], callers[t], 100.0 * callers[t] / all[t], clock[t]);
  }
}

}  // namespace
}  // namespace prospect

int main() {
  using namespace prospect;
  std::printf("| ns a stage of a rollout | scored | values | ratio |\n|---|---|---|---|\n");
  for (const int samples : {32, 128, 512, 2048}) {
    report("R1, " + std::to_string(samples) + " samples", make_r1(), samples, 8192);
  }
  for (const int samples : {32, 128, 512}) {
    planner("planner, " + std::to_string(samples) + " samples", samples, 20, 300);
  }
  for (const int N : {10, 50, 100}) {
    planner("planner, " + std::to_string(N) + " stages", 128, N, 300);
  }
  for (const int landmarks : {100, 1000, 3000}) {
    planner("planner, " + std::to_string(landmarks) + " landmarks", 128, 20, landmarks);
  }
  std::printf(
      "\n| ms a solve | threads | of the processor | of it the caller | share | least by the clock "
      "|\n"
      "|---|---|---|---|---|---|\n");
  threads("R1, 4096 evaluations", make_r1(), 4096);
  for (const int landmarks : {300, 3000}) {
    PlannerParameters parameters;
    parameters.max_landmarks = landmarks;
    const test::PlanningScene scene("unicycle_accel", parameters, landmarks + landmarks / 3);
    threads("planner, " + std::to_string(landmarks) + " landmarks, 1024 evaluations",
            *scene.problem, 1024);
  }
}
