// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace prospect {

/// How long something took, counted in logarithmic bins: 10 us to 100 s, 20 bins a decade, so that
/// a bin's ends differ by a factor of 1.122. Size and time of add() do not depend on what was
/// counted.
///
/// A value. Errors: none; what is no time is counted as `invalid`. Thread-safety: as any value.
class LatencyHistogram {
 public:
  static constexpr double kShortest = 1e-5;  ///< [s]; the first bin holds all up to it
  static constexpr int kBinsPerDecade = 20;
  static constexpr int kDecades = 7;
  /// The last one holds all that is longer than 100 s.
  static constexpr int kBins = kBinsPerDecade * kDecades + 2;

  /// seconds: finite and not negative; counted as invalid otherwise.
  void add(double seconds);
  /// As if all that the other one counted had been added here.
  void merge(const LatencyHistogram& other);

  std::uint64_t count() const { return count_; }
  std::uint64_t invalid() const { return invalid_; }
  double maximum() const { return maximum_; }  ///< [s] exact; 0 if nothing was counted
  /// The least time [s] that the share p, 0 to 1, of all does not exceed, rounded up to the end of
  /// its bin, but no more than the maximum; 0 if nothing was counted.
  double quantile(double p) const;

  /// The upper end of a bin [s]; infinite for the last.
  static double upper_end(int bin);
  std::uint64_t in_bin(int bin) const { return bins_[static_cast<std::size_t>(bin)]; }

  /// "n 1200, p50 14.1 ms, p99 42.2 ms, max 57.3 ms"; with ", 3 invalid" if there are any; "n 0".
  std::string to_text() const;

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0, invalid_ = 0;
  double maximum_ = 0.0;
};

/// "84 us", "14.1 ms", "2.31 s": three digits.
std::string duration_text(double seconds);

}  // namespace prospect
