// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace prospect {

class Knobs;

/// How long tracks live, learned from those that live and those that died.
///
/// Every landmark has its own probability q to be lost at a view of it, and q is Beta(b, a)
/// distributed over the map: a corner of a distant wall lasts, a leaf or the edge of something near
/// does not. A landmark that was found n times since it was made is then lost at the next view with
/// probability
///   b / (a + b + n),
/// and found at all of the next H views with
///   prod_{j = 0..H-1} (a + n + j) / (a + b + n + j),
/// the beta-geometric distribution (Weinberg and Gladen 1986). So a young landmark takes the mean
/// of the map, an old one is worth more, and the prior's strength a + b says how much more. The
/// share of views at which a landmark of the map was found does not do: those that were not are no
/// longer in the map.
///
/// (a, b) is the most probable pair given the views of all landmarks, dead ones included, counted
/// by n; older views count less and less. Before there are any, what is not known is where the
/// robot is: in a room next to nothing is lost, on a road a fifth at every view. The loss of a
/// place is then itself Beta distributed, with mean `prior_loss` and strength `prior_views`, and so
/// is what the first image's landmarks are given.
///
/// A landmark that was missed at the newest view is found again with a probability that is learned
/// likewise, as one share for all.
///
/// Deterministic. Not thread-safe for writing.
class TrackSurvival {
 public:
  struct Options {
    double prior_loss = 0.07;  ///< at a view, mean over places
    double prior_views = 4.0;  ///< that this counts for: the less, the more places differ
    double memory = 300.0;     ///< [frames] after which a view counts for 1/e
  };
  struct Fit {
    double loss = 0.0;      ///< b / (a + b): mean probability to be lost at the first view
    double strength = 0.0;  ///< a + b [views]
    double again = 0.0;     ///< probability that a missed landmark is found at the next view
  };

  TrackSurvival() : TrackSurvival(Options()) {}
  /// Throws std::invalid_argument naming the option.
  explicit TrackSurvival(const Options& options);

  /// A view of a landmark that was found at its last one, and `found_before` >= 0 times in all.
  void add(int found_before, bool found);
  /// A view of a landmark that was missed at its last one.
  void add_missed(bool found);
  /// Once a frame.
  void forget();

  Fit fit() const;
  /// Probability that a landmark found so often is found at all of the next `views` >= 1; of one
  /// that was missed at its last view, `missed`, the first of them has probability `again`.
  static double probability(const Fit& fit, int found_before, bool missed, int views);

 private:
  static constexpr int kAges = 64;  // the last one stands for all that are older

  Options options_;
  std::array<double, kAges> views_{}, lost_{};
  double missed_views_ = 0.0, found_again_ = 0.0;
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, TrackSurvival::Options& options);

}  // namespace prospect
