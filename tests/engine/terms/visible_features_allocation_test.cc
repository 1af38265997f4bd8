// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <new>
#include <random>

#include "engine/terms/visible_features.h"
#include "models/make_model.h"
#include "tests/engine/visibility_scene.h"

namespace {
long allocations = 0;
}

// Counts every allocation of this program. Not inlined, so that the compiler does not pair the
// library's new with our free.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const std::size_t a = static_cast<std::size_t>(alignment);
  if (void* p = std::aligned_alloc(a, (size + a - 1) / a * a)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}

namespace prospect::visible_features_allocation_test {
namespace {

TEST(VisibleFeaturesAllocation, EvaluatingDoesNotAllocate) {
  std::mt19937_64 rng(51);
  const auto model = make_model("unicycle");
  const auto landmarks = visibility_scene::landmarks(rng, 120);
  const TrajectoryBatch t = visibility_scene::walks(rng, *model, 10, 0.3, 1);
  const TrajectoryBatch many = visibility_scene::walks(rng, *model, 10, 0.3, 50);
  TermOutput out = visibility_scene::output(t), out_many = visibility_scene::output(many);
  for (const auto criterion : {VisibilityCriterion::kCount, VisibilityCriterion::kInformation}) {
    VisibleFeaturesParameters f;
    f.criterion = criterion;
    f.chance_weight = 1.0;
    const VisibleFeatures term(
        std::make_shared<const VisibilityPrediction>(landmarks, StereoCamera{}, CameraMount{},
                                                     nullptr, VisibilityParameters{}),
        f);
    const long before_scratch = allocations;
    const auto scratch = term.make_scratch(t.horizon, 50);
    EXPECT_GT(allocations, before_scratch);  // the counter counts
    const long before = allocations;
    term.evaluate(t, {true}, scratch.get(), out);
    term.evaluate(many, {false}, scratch.get(), out_many);
    EXPECT_EQ(allocations, before);
  }
}

}  // namespace
}  // namespace prospect::visible_features_allocation_test
