// SPDX-License-Identifier: Apache-2.0
// A problem with all terms, made by the planner, must not allocate once it has been evaluated with
// a workspace and batch size. Every way to the heap is counted: the C library's, which operator new
// and Eigen's aligned allocations end in.

#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include "tests/engine/planning_scene.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define PROSPECT_COUNTS_ALLOCATIONS 0
#else
#define PROSPECT_COUNTS_ALLOCATIONS 1
#endif

namespace {
std::atomic<long> allocations{0};
}

#if PROSPECT_COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* p, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) {
  ++allocations;
  return __libc_realloc(p, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) {
  ++allocations;
  *p = __libc_memalign(alignment, size);
  return *p ? 0 : ENOMEM;
}
}
#endif

namespace prospect::problem_allocation_test {
namespace {

struct Case {
  std::string name;
  std::string model;
  PlannerParameters parameters;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  PlannerParameters everything;
  everything.weights.heading_alignment = 0.1;
  everything.w_c = 0.5;
  for (const char* model : {"unicycle", "unicycle_accel", "holonomic"}) {
    all.push_back({model, model, everything});
  }
  PlannerParameters information = everything;
  information.features.criterion = VisibilityCriterion::kInformation;
  information.unknown = UnknownPolicy::kBlocked;
  all.push_back({"information", "unicycle_accel", information});
  PlannerParameters bare = everything;
  bare.feature_prior = false;
  bare.unknown = UnknownPolicy::kFree;
  all.push_back({"no_prior", "unicycle", bare});
  PlannerParameters flying = everything;
  flying.visibility_lattice = 0.8;
  all.push_back({"multirotor", "multirotor", flying});
  return all;
}

TEST(ProblemAllocation, NoneAfterTheFirstEvaluationOfEachBatchSize) {
  if (!PROSPECT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "the sanitizer owns the heap";
  for (const Case& c : cases()) {
    const test::PlanningScene scene(c.model, c.parameters, 200);
    const Problem& problem = *scene.problem;
    EXPECT_GE(problem.definition().terms.size(), 8u) << c.name;
    std::mt19937_64 random(2);
    const Eigen::MatrixXd X = scene.points(30, random);
    Workspace workspace = problem.make_workspace();
    Evaluation single, gradient, stages, residuals, batch, scores;
    const long before_first = allocations;
    problem.evaluate(X.col(0), Evaluate::kValue, workspace, single);
    EXPECT_GT(allocations, before_first) << "the counter does not count";
    problem.evaluate(X.col(0), Evaluate::kGradient, workspace, gradient);
    problem.evaluate(X.col(0), Evaluate::kStages, workspace, stages);
    problem.evaluate(X.col(0), Evaluate::kResiduals, workspace, residuals);
    problem.evaluate(X, Evaluate::kValue, workspace, batch);
    problem.evaluate(X, Evaluate::kScore, workspace, scores);
    problem.evaluate(X.col(0), Evaluate::kValue, workspace, single);
    problem.evaluate(X.col(0), Evaluate::kGradient, workspace, gradient);
    for (int b = 0; b < 30; ++b) {
      // Sizes taken in turn, at other points each time.
      const long before = allocations;
      problem.evaluate(X.col(b), Evaluate::kValue, workspace, single);
      const long value = allocations;
      problem.evaluate(X.col(b), Evaluate::kGradient, workspace, gradient);
      const long with_gradient = allocations;
      problem.evaluate(X.col(b), Evaluate::kStages, workspace, stages);
      problem.evaluate_states(X.col(b), stages.stages.states, workspace, stages);
      const long with_stages = allocations;
      problem.evaluate(X.col(b), Evaluate::kResiduals, workspace, residuals);
      const long with_residuals = allocations;
      problem.evaluate(X, Evaluate::kValue, workspace, batch);
      const long with_batch = allocations;
      problem.evaluate(X, Evaluate::kScore, workspace, scores);
      const long with_scores = allocations;
      ASSERT_EQ(value - before, 0) << c.name << ", value";
      ASSERT_EQ(with_gradient - value, 0) << c.name << ", gradient";
      ASSERT_EQ(with_stages - with_gradient, 0) << c.name << ", stages";
      ASSERT_EQ(with_residuals - with_stages, 0) << c.name << ", residuals";
      ASSERT_EQ(with_batch - with_residuals, 0) << c.name << ", batch";
      ASSERT_EQ(with_scores - with_batch, 0) << c.name << ", scores";
      ASSERT_EQ(single.cost[0], batch.cost[b]) << c.name;
      ASSERT_EQ(gradient.cost[0], single.cost[0]) << c.name;
    }
    // Nobody evaluated nothing.
    EXPECT_TRUE(batch.valid.all()) << c.name;
    EXPECT_GT(gradient.gradient.norm(), 0.0) << c.name;
  }
}

}  // namespace
}  // namespace prospect::problem_allocation_test
