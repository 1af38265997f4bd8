// SPDX-License-Identifier: Apache-2.0
#include "runtime/latency_histogram.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace prospect {
namespace {

using Ends = std::array<double, LatencyHistogram::kBins>;

Ends upper_ends() {
  Ends ends{};
  for (int bin = 0; bin + 1 < LatencyHistogram::kBins; ++bin) {
    ends[static_cast<std::size_t>(bin)] =
        LatencyHistogram::kShortest *
        std::pow(10.0, static_cast<double>(bin) / LatencyHistogram::kBinsPerDecade);
  }
  ends.back() = std::numeric_limits<double>::infinity();
  return ends;
}

const Ends& ends() {
  static const Ends kEnds = upper_ends();
  return kEnds;
}

}  // namespace

double LatencyHistogram::upper_end(int bin) { return ends()[static_cast<std::size_t>(bin)]; }

void LatencyHistogram::add(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0.0) {
    ++invalid_;
    return;
  }
  const auto bin = std::lower_bound(ends().begin(), ends().end(), seconds) - ends().begin();
  ++bins_[static_cast<std::size_t>(bin)];
  ++count_;
  maximum_ = std::max(maximum_, seconds);
}

void LatencyHistogram::merge(const LatencyHistogram& other) {
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) bins_[bin] += other.bins_[bin];
  count_ += other.count_;
  invalid_ += other.invalid_;
  maximum_ = std::max(maximum_, other.maximum_);
}

double LatencyHistogram::quantile(double p) const {
  if (count_ == 0) return 0.0;
  const double share = std::clamp(std::isnan(p) ? 1.0 : p, 0.0, 1.0);
  const double rank = std::max(1.0, std::ceil(share * static_cast<double>(count_)));
  double so_far = 0.0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    so_far += static_cast<double>(bins_[bin]);
    if (so_far >= rank) return std::min(ends()[bin], maximum_);
  }
  return maximum_;
}

std::string duration_text(double seconds) {
  char text[48];
  // Three digits round up to the next unit.
  const auto in = [&](double scale, const char* unit) {
    const double value = seconds * scale;
    const double size = std::abs(value);
    const int digits = size < 9.995 ? 2 : size < 99.95 ? 1 : 0;
    std::snprintf(text, sizeof text, "%.*f %s", digits, value, unit);
    return std::string(text);
  };
  if (!std::isfinite(seconds)) return in(1.0, "s");
  if (std::abs(seconds) < 0.9995e-3) {
    std::snprintf(text, sizeof text, "%.0f us", seconds * 1e6);
    return text;
  }
  return std::abs(seconds) < 0.9995 ? in(1e3, "ms") : in(1.0, "s");
}

std::string LatencyHistogram::to_text() const {
  std::string text = "n " + std::to_string(count_);
  if (count_ > 0) {
    text += ", p50 " + duration_text(quantile(0.5)) + ", p99 " + duration_text(quantile(0.99)) +
            ", max " + duration_text(maximum_);
  }
  if (invalid_ > 0) text += ", " + std::to_string(invalid_) + " invalid";
  return text;
}

}  // namespace prospect
