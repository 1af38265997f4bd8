// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/reliability.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace prospect {
namespace {

void require_parallel(std::size_t a, std::size_t b) {
  if (a != b) {
    throw std::invalid_argument("reliability: " + std::to_string(a) + " predictions but " +
                                std::to_string(b) + " outcomes; expected one for each");
  }
}

}  // namespace

Reliability reliability(const std::vector<double>& predicted, const std::vector<char>& outcome) {
  require_parallel(predicted.size(), outcome.size());
  Reliability r;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const double p = predicted[i];
    if (!(p >= 0.0 && p <= 1.0)) {
      throw std::invalid_argument("reliability: prediction " + std::to_string(i) + " is " +
                                  std::to_string(p) + "; expected 0 to 1");
    }
    const double came_true = outcome[i] ? 1.0 : 0.0;
    ReliabilityBin& bin = r.bins[static_cast<std::size_t>(std::min(9.0, 10.0 * p))];
    ++bin.count;
    bin.predicted += p;
    bin.observed += came_true;
    ++r.count;
    r.predicted += p;
    r.observed += came_true;
    r.brier += (p - came_true) * (p - came_true);
  }
  if (r.count == 0) return r;
  for (ReliabilityBin& bin : r.bins) {
    r.error += std::abs(bin.predicted - bin.observed) / r.count;
    if (bin.count == 0) continue;
    bin.predicted /= bin.count;
    bin.observed /= bin.count;
  }
  r.predicted /= r.count;
  r.observed /= r.count;
  r.brier /= r.count;
  return r;
}

CountAgreement count_agreement(const std::vector<double>& predicted,
                               const std::vector<double>& counted) {
  require_parallel(predicted.size(), counted.size());
  CountAgreement a;
  a.count = static_cast<int>(predicted.size());
  a.correlation = std::numeric_limits<double>::quiet_NaN();
  if (a.count == 0) return a;
  const double n = a.count;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    a.predicted += predicted[i] / n;
    a.counted += counted[i] / n;
    a.mean_absolute_error += std::abs(predicted[i] - counted[i]) / n;
  }
  a.bias = a.predicted - a.counted;
  double pp = 0.0, cc = 0.0, pc = 0.0;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const double p = predicted[i] - a.predicted, c = counted[i] - a.counted;
    pp += p * p;
    cc += c * c;
    pc += p * c;
  }
  // Below this, what varies is rounding.
  const double least = 1e-18 * n * (1.0 + a.predicted * a.predicted + a.counted * a.counted);
  if (pp > least && cc > least) a.correlation = pc / std::sqrt(pp * cc);
  return a;
}

}  // namespace prospect
