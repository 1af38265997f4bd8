// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/signed_rank_test.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace prospect {
namespace {

constexpr int kMostExact = 25;

/// P(sum of the ranks that are drawn, each with probability 1/2, <= w); ranks and w doubled, so
/// that mean ranks of ties are whole numbers.
double lower_tail(const std::vector<int>& doubled_ranks, int doubled_w) {
  int total = 0;
  for (const int r : doubled_ranks) total += r;
  std::vector<double> ways(static_cast<std::size_t>(total) + 1, 0.0);
  ways[0] = 1.0;
  int reached = 0;
  for (const int r : doubled_ranks) {
    reached += r;
    for (int s = reached; s >= r; --s) {
      ways[static_cast<std::size_t>(s)] += ways[static_cast<std::size_t>(s - r)];
    }
  }
  double below = 0.0;  // exact: counts up to 2^25
  for (int s = 0; s <= doubled_w; ++s) below += ways[static_cast<std::size_t>(s)];
  return std::ldexp(below, -static_cast<int>(doubled_ranks.size()));
}

}  // namespace

SignedRankTest signed_rank_test(const std::vector<double>& differences) {
  SignedRankTest test;
  std::vector<double> d;
  for (const double difference : differences) {
    if (!std::isfinite(difference)) {
      throw std::invalid_argument("signed_rank_test: a difference is not finite");
    }
    if (difference != 0.0) d.push_back(difference);
  }
  test.n = static_cast<int>(d.size());
  test.zeros = static_cast<int>(differences.size() - d.size());
  std::sort(d.begin(), d.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });

  std::vector<int> doubled_ranks;
  double ties = 0.0;
  for (std::size_t begin = 0; begin < d.size();) {
    std::size_t end = begin + 1;
    while (end < d.size() && std::abs(d[end]) == std::abs(d[begin])) ++end;
    const int doubled = static_cast<int>(begin + 1 + end);  // first and last rank together
    for (std::size_t i = begin; i < end; ++i) {
      doubled_ranks.push_back(doubled);
      (d[i] > 0.0 ? test.w_plus : test.w_minus) += 0.5 * doubled;
    }
    const auto t = static_cast<double>(end - begin);
    ties += t * t * t - t;
    begin = end;
  }

  const double w = std::min(test.w_plus, test.w_minus);
  test.exact = test.n <= kMostExact;
  if (test.exact) {
    test.p = std::min(1.0, 2.0 * lower_tail(doubled_ranks, static_cast<int>(2.0 * w)));
    return test;
  }
  const double n = test.n;
  const double mean = n * (n + 1.0) / 4.0;
  const double variance = n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - ties / 48.0;
  const double z = std::max(0.0, mean - w - 0.5) / std::sqrt(variance);
  test.p = std::erfc(z / std::sqrt(2.0));
  return test;
}

}  // namespace prospect
