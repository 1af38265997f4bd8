// SPDX-License-Identifier: Apache-2.0
// What share of the core's arithmetic the kernel of visible features reaches, and what bounds it:
// its time over landmarks that all lie before the camera, in every vector width; the core's peak,
// measured by independent chains of operations in registers; and the parts the kernel is made of
// (exponential, normal distribution, division, square root), each over the same number of lanes.

#include <benchmark/benchmark.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "engine/features/visibility_prediction.h"
#include "engine/support/instruction_set.h"
#include "engine/support/normal_distribution.h"
#include "models/unicycle.h"
#include "tests/engine/visibility_scene.h"

namespace prospect {
namespace {

#if defined(__x86_64__)
// Twelve chains hide the latency of an operation (4 cycles, two pipes). Each step is one fused
// multiply-add, or one multiplication and one addition: two operations a lane either way.
#define PEAK(NAME, TARGET, V, SET, STEP, LANES)                                                \
  __attribute__((target(TARGET))) void NAME(benchmark::State& state) {                         \
    V x[12];                                                                                   \
    for (int i = 0; i < 12; ++i) x[i] = SET(1.0 + i);                                          \
    const V a = SET(0.999999), b = SET(1e-6);                                                  \
    for (auto _ : state) {                                                                     \
      for (int n = 0; n < 1000; ++n) {                                                         \
        _Pragma("GCC unroll 12") for (int i = 0; i < 12; ++i) x[i] = STEP;                     \
      }                                                                                        \
      for (int i = 0; i < 12; ++i) benchmark::DoNotOptimize(x[i]);                             \
    }                                                                                          \
    state.counters["operations"] =                                                             \
        benchmark::Counter(12e3 * 2.0 * LANES, benchmark::Counter::kIsIterationInvariantRate); \
  }

PEAK(peak_fused_avx2, "avx2,fma", __m256d, _mm256_set1_pd, _mm256_fmadd_pd(x[i], a, b), 4)
PEAK(peak_fused_avx512, "avx512f", __m512d, _mm512_set1_pd, _mm512_fmadd_pd(x[i], a, b), 8)
PEAK(peak_separate_avx2, "avx2", __m256d, _mm256_set1_pd, _mm256_add_pd(_mm256_mul_pd(x[i], a), b),
     4)
PEAK(peak_separate_avx512, "avx512f", __m512d, _mm512_set1_pd,
     _mm512_add_pd(_mm512_mul_pd(x[i], a), b), 8)
#undef PEAK
#endif

constexpr int kLandmarks = 304;  // whole blocks

std::vector<Landmark> landmarks_in_view() {
  std::mt19937_64 random(1);
  std::vector<Landmark> all = visibility_scene::landmarks(random, kLandmarks);
  for (Landmark& l : all) {
    const double depth = visibility_scene::uniform(random, 1.0, 4.0);
    l.position = {depth, visibility_scene::uniform(random, -0.5, 0.5) * depth,
                  0.45 + visibility_scene::uniform(random, -0.3, 0.3) * depth};
    l.creation_direction = {-1.0, 0.0, 0.0};
    l.creation_range = depth;
  }
  return all;
}

/// The recursion over 21 stages without lines of sight and information: the kernel, and less than
/// a tenth of other work. A counter in landmarks of a stage.
void prediction(benchmark::State& state, const VisibilityKernel& kernel,
                const VisibilityPrediction::Request& request) {
  const Unicycle model;
  std::mt19937_64 random(2);
  const TrajectoryBatch t = visibility_scene::walks(random, model, 20, 0.25, 1, 0.0, 0.0);
  TrajectoryBatch ahead = t;
  for (int k = 0; k <= 20; ++k) {
    ahead.states(k * model.nx() + t.layout.px, 0) = 0.01 * k;
    ahead.states(k * model.nx() + t.layout.py, 0) = 0.0;
    ahead.states(k * model.nx() + t.layout.yaw, 0) = 0.002 * k;
  }
  const VisibilityPrediction prediction(landmarks_in_view(), StereoCamera(), CameraMount(), nullptr,
                                        VisibilityParameters(), kernel);
  const auto scratch = prediction.make_scratch(ahead.horizon);
  for (auto _ : state) {
    if (!prediction.propagate(ahead, 0, request, nullptr, *scratch)) {
      state.SkipWithError("a pose is not finite");
    }
    benchmark::ClobberMemory();
  }
  state.counters["landmark_stages"] =
      benchmark::Counter(21.0 * kLandmarks, benchmark::Counter::kIsIterationInvariantRate);
}

struct Lanes {
  alignas(64) double in[kLandmarks], out[kLandmarks];
  Lanes() {
    for (int i = 0; i < kLandmarks; ++i) in[i] = 0.5 + 0.01 * i;
  }
};

PROSPECT_FORCE_INLINE double normal_part(double x) {
  double cdf, density;
  normal_in_range(x, cdf, density);
  return cdf + density;
}

#define PARTS(SUFFIX, TARGET)                                                      \
  TARGET void exponential_##SUFFIX(Lanes& l) {                                     \
    for (int i = 0; i < kLandmarks; ++i) l.out[i] = exponential_in_range(l.in[i]); \
  }                                                                                \
  TARGET void normal_##SUFFIX(Lanes& l) {                                          \
    for (int i = 0; i < kLandmarks; ++i) l.out[i] = normal_part(l.in[i]);          \
  }                                                                                \
  TARGET void division_##SUFFIX(Lanes& l) {                                        \
    for (int i = 0; i < kLandmarks; ++i) l.out[i] = 1.0 / l.in[i];                 \
  }                                                                                \
  TARGET void root_##SUFFIX(Lanes& l) {                                            \
    for (int i = 0; i < kLandmarks; ++i) l.out[i] = std::sqrt(l.in[i]);            \
  }

PARTS(generic, )
#if defined(__x86_64__)
PARTS(avx2, PROSPECT_TARGET_AVX2)
PARTS(avx512, PROSPECT_TARGET_AVX512)
#endif
#undef PARTS

void part(benchmark::State& state, void (*run)(Lanes&)) {
  const auto lanes = std::make_unique<Lanes>();
  for (auto _ : state) {
    run(*lanes);
    benchmark::ClobberMemory();
  }
  state.counters["lanes"] =
      benchmark::Counter(kLandmarks, benchmark::Counter::kIsIterationInvariantRate);
}

struct Parts {
  void (*exponential)(Lanes&);
  void (*normal)(Lanes&);
  void (*division)(Lanes&);
  void (*root)(Lanes&);
};

Parts parts(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) {
    return {exponential_avx512, normal_avx512, division_avx512, root_avx512};
  }
  if (set == InstructionSet::kAvx2) {
    return {exponential_avx2, normal_avx2, division_avx2, root_avx2};
  }
#endif
  (void)set;
  return {exponential_generic, normal_generic, division_generic, root_generic};
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  using namespace prospect;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    benchmark::RegisterBenchmark("peak/fused/avx2", peak_fused_avx2);
    benchmark::RegisterBenchmark("peak/separate/avx2", peak_separate_avx2);
  }
  if (best_instruction_set() == InstructionSet::kAvx512) {
    benchmark::RegisterBenchmark("peak/fused/avx512", peak_fused_avx512);
    benchmark::RegisterBenchmark("peak/separate/avx512", peak_separate_avx512);
  }
#endif
  for (const VisibilityKernel& kernel : available_visibility_kernels()) {
    const std::string name = "kernel/" + std::string(kernel.name);
    benchmark::RegisterBenchmark((name + "/score").c_str(), prediction, kernel,
                                 VisibilityPrediction::Request{.score = true});
    benchmark::RegisterBenchmark((name + "/value").c_str(), prediction, kernel,
                                 VisibilityPrediction::Request{});
    benchmark::RegisterBenchmark((name + "/gradient").c_str(), prediction, kernel,
                                 VisibilityPrediction::Request{.gradient = true});
  }
  for (const InstructionSet set : available_instruction_sets()) {
    const std::string width(name(set));
    const Parts p = parts(set);
    benchmark::RegisterBenchmark(("part/exponential/" + width).c_str(), part, p.exponential);
    benchmark::RegisterBenchmark(("part/normal/" + width).c_str(), part, p.normal);
    benchmark::RegisterBenchmark(("part/division/" + width).c_str(), part, p.division);
    benchmark::RegisterBenchmark(("part/root/" + width).c_str(), part, p.root);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
