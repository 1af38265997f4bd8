// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace prospect {

class Knobs;

/// Whether two sensors that measure the same lengths agree about the metre. One stereo pair alone
/// cannot tell: with a baseline or focal length wrong by a factor everything it sees is wrong by
/// that factor, consistently.
struct ScaleAgreement {
  enum class Verdict { kUnknown, kAgree, kDisagree };
  Verdict verdict = Verdict::kUnknown;
  double ratio = 1.0;  ///< of the first sensor's lengths to the second's, the median
  double sigma = 0.0;  ///< of ln(ratio), with what both may be off by
  int samples = 0;
};

struct ScaleAgreementOptions {
  double least = 0.05;        ///< of |ln ratio| that matters
  double significance = 4.0;  ///< standard deviations
  int least_samples = 6;      ///< fewer say nothing
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, ScaleAgreementOptions& options);

/// The verdict on samples of ln(length by the first / length by the second):
///   m = median,   spread = max(expected, 1.4826 median|sample - m|),
///   sigma^2 = systematic^2 + (1.2533 spread)^2 / n,
///   kDisagree if |m| > max(least, significance sigma),
/// so up to half of the samples may be wrong in any way, and samples that contradict each other
/// accuse nobody. 1.2533 = sqrt(pi / 2) is what a median's standard deviation is above a mean's,
/// 1.4826 makes a standard deviation of a median absolute deviation, both of Gaussian noise.
/// expected: standard deviation of a sample, at least, as the sensors claim it: of few samples the
/// spread itself is not known. systematic: of what all samples share. [-]
ScaleAgreement scale_agreement(std::vector<double> log_ratios, double expected, double systematic,
                               const ScaleAgreementOptions& options = {});

/// "WHAT 1.500 times as long as WHOSE, +- 0.8 % (12 samples)", for a reason or a refusal.
std::string to_string(const ScaleAgreement& agreement, std::string_view what,
                      std::string_view whose);

}  // namespace prospect
