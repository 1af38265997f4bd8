// SPDX-License-Identifier: Apache-2.0
#include "runtime/latency_histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace prospect::latency_histogram_test {
namespace {

constexpr double kRatio = 1.1220184543019633;  // 10^(1/20)

TEST(LatencyHistogram, BinsAreLogarithmic) {
  EXPECT_DOUBLE_EQ(LatencyHistogram::upper_end(0), 1e-5);
  EXPECT_DOUBLE_EQ(LatencyHistogram::upper_end(20), 1e-4);
  EXPECT_DOUBLE_EQ(LatencyHistogram::upper_end(LatencyHistogram::kBins - 2), 100.0);
  EXPECT_TRUE(std::isinf(LatencyHistogram::upper_end(LatencyHistogram::kBins - 1)));
  for (int bin = 1; bin + 1 < LatencyHistogram::kBins; ++bin) {
    EXPECT_NEAR(LatencyHistogram::upper_end(bin) / LatencyHistogram::upper_end(bin - 1), kRatio,
                1e-12);
  }
}

TEST(LatencyHistogram, EveryTimeIsInTheBinThatHoldsIt) {
  struct Case {
    double seconds;
    int bin;  // -1: invalid
  };
  const double inf = std::numeric_limits<double>::infinity();
  for (const Case& c : {Case{0.0, 0},
                        {1e-9, 0},
                        {1e-5, 0},
                        {1.0001e-5, 1},
                        {1.0001e-4, 21},
                        {1.5e-2, 64},
                        {99.999, LatencyHistogram::kBins - 2},
                        {101.0, LatencyHistogram::kBins - 1},
                        {1e6, LatencyHistogram::kBins - 1},
                        {-1e-9, -1},
                        {inf, -1},
                        {-inf, -1},
                        {std::nan(""), -1}}) {
    LatencyHistogram h;
    h.add(c.seconds);
    EXPECT_EQ(h.count(), c.bin < 0 ? 0u : 1u) << c.seconds;
    EXPECT_EQ(h.invalid(), c.bin < 0 ? 1u : 0u) << c.seconds;
    EXPECT_EQ(h.maximum(), c.bin < 0 ? 0.0 : c.seconds);
    if (c.bin < 0) continue;
    EXPECT_EQ(h.in_bin(c.bin), 1u) << c.seconds;
  }
}

// Against the sorted values themselves: never below, and above by no more than a bin.
TEST(LatencyHistogram, QuantilesAreThoseOfTheValues) {
  std::mt19937 random(7);
  std::lognormal_distribution<double> times(std::log(0.02), 1.5);
  LatencyHistogram h;
  std::vector<double> values;
  for (int n = 0; n < 2000; ++n) {
    values.push_back(times(random));
    h.add(values.back());
  }
  std::sort(values.begin(), values.end());
  EXPECT_EQ(h.maximum(), values.back());
  EXPECT_EQ(h.quantile(1.0), values.back());
  for (const double p : {0.0, 0.01, 0.5, 0.9, 0.99, 0.9995}) {
    const auto rank = static_cast<std::size_t>(std::max(1.0, std::ceil(p * 2000.0)));
    const double exact = values[rank - 1];
    EXPECT_GE(h.quantile(p), exact) << p;
    EXPECT_LE(h.quantile(p), std::max(LatencyHistogram::kShortest, exact * kRatio)) << p;
  }
}

TEST(LatencyHistogram, MergingIsAddingAll) {
  LatencyHistogram a, b, both;
  for (int n = 1; n <= 300; ++n) {
    const double seconds = 1e-4 * n * n;
    (n % 3 ? a : b).add(seconds);
    both.add(seconds);
  }
  b.add(-1.0);
  both.add(-1.0);
  a.merge(b);
  EXPECT_EQ(a.to_text(), both.to_text());
  for (int bin = 0; bin < LatencyHistogram::kBins; ++bin)
    EXPECT_EQ(a.in_bin(bin), both.in_bin(bin));
}

TEST(LatencyHistogram, Text) {
  LatencyHistogram h;
  EXPECT_EQ(h.to_text(), "n 0");
  for (int n = 0; n < 99; ++n) h.add(0.010);
  h.add(2.345);
  EXPECT_EQ(h.to_text(), "n 100, p50 10.0 ms, p99 10.0 ms, max 2.35 s");
  h.add(-1.0);
  EXPECT_EQ(h.to_text(), "n 100, p50 10.0 ms, p99 10.0 ms, max 2.35 s, 1 invalid");
  EXPECT_EQ(h.quantile(0.995), 2.345);  // the maximum, not the end of its bin
}

TEST(LatencyHistogram, DurationsHaveThreeDigits) {
  struct Case {
    double seconds;
    const char* text;
  };
  for (const Case& c : {Case{0.0, "0 us"}, Case{84e-6, "84 us"}, Case{0.9996e-3, "1.00 ms"},
                        Case{14.12e-3, "14.1 ms"}, Case{0.123456, "123 ms"}, Case{0.9997, "1.00 s"},
                        Case{12.34, "12.3 s"}, Case{345.6, "346 s"}, Case{-0.02, "-20.0 ms"},
                        Case{INFINITY, "inf s"}}) {
    EXPECT_EQ(duration_text(c.seconds), c.text);
  }
}

}  // namespace
}  // namespace prospect::latency_histogram_test
