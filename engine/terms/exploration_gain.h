// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/features/footprint_visibility.h"
#include "engine/frontiers/exploration_targets.h"
#include "engine/problem/term.h"
#include "engine/terms/new_surface.h"
#include "models/camera.h"
#include "models/robot_description.h"

namespace prospect {

class OcclusionTable;

/// Expected newly explored area over the horizon, relative to what there is to explore nearby:
///
///   gain = sum_c m_c (1 - prod_{k=1..N} (1 - eta q_ck e^{-t_k / tau})) / A_ref      [-], >= 0
///   q_ck = max(0, v_ck - v_c0)^2 / (v_ck (1 - v_c0))
///
/// v_ck is FootprintVisibility of target c at stage k, t_k = k dt; of several depth sensors s,
/// which look independently, v_ck = 1 - prod_s (1 - v_cks): a place that one of them sees is seen.
/// Each sees a target at its own height, as a target stands for columns (positions(raised)). With
/// independent views the bracket is the probability that c is seen at least once, so no cell counts
/// twice. But a view from where the robot stands is not independent of the one that it has just
/// taken: what it could see is seen, and a target that is unknown all the same needs a better view.
/// q_ck is the share of it, (v_ck - v_c0) / (1 - v_c0) where that is positive, made C1 like the
/// cut-off of v. Otherwise every plan stands still a while before cells that it half sees, and
/// every replan again: with sensors that leave some cells unresolved the robot stares at them. v_c0
/// is of the pose `present`, constant; 0 without one. The factor e^{-t/tau} is a time preference:
/// without it looking later costs the same as looking now, and every replan defers again. Stage 0
/// is the present and cannot be chosen; it does not count.
///
/// The raw value is the gain, a reward: its weight in a Problem is negative (-w_e).
/// The gradient runs over suffix products instead of dividing by (1 - eta q): exact for eta up
/// to 1.
///
/// Residuals of -gain, a reward: sqrt(2 m_c / A_ref prod_k (1 - eta q_ck e^{-t_k / tau})) in row c,
/// what stays unseen of target c, over the offset -sum_c m_c / A_ref.
///
/// As NewSurface it predicts, without the time preference (that is a preference, not a
/// probability),
///   A_k = surface_per_area sum_c m_c eta q_ck prod_{0<j<k} (1 - eta q_cj) [m^2],   A_0 = 0.
///
/// Both need the same views q_ck and their derivatives; within one evaluation of a Problem they are
/// computed once (SharedResults).
///
/// Smoothness: C1. Thread-safety: immutable; concurrent calls need separate scratch. One scratch
/// serves either interface, but add_gradient() must directly follow its evaluate().
/// Non-finite poses give a NaN value, which rejects the candidate.
/// Source: formulation, section 4 (gain) and section 3 (prior).
class ExplorationGain : public Term, public NewSurface {
 public:
  struct Options {
    double eta = 0.9;               ///< chance that a view in full view resolves a cell; in (0, 1)
    double tau = 4.0;               ///< time preference [s]
    double surface_per_area = 1.0;  ///< surface seen per newly explored ground area [-]
    FootprintVisibility::Options visibility;
  };

  /// A depth sensor, and its lines of sight to the targets, raised to its height.
  struct Sight {
    DepthSensor sensor;
    std::shared_ptr<const OcclusionTable> table;
  };

  /// At least one sight; that of sensor n has a table of exactly positions(height of n - height of
  /// 0), heights those of the mounts. Throws std::invalid_argument otherwise, or for an option out
  /// of its range or a present pose that is not finite.
  ExplorationGain(const ExplorationTargets& targets, std::vector<Sight> sights,
                  const Options& options, const std::optional<Pose>& present = std::nullopt);
  /// Of one sensor.
  ExplorationGain(const ExplorationTargets& targets, const RgbdFootprint& footprint,
                  const CameraMount& mount, std::shared_ptr<const OcclusionTable> table,
                  const Options& options, const std::optional<Pose>& present = std::nullopt);
  ExplorationGain(const ExplorationTargets& targets, const RgbdFootprint& footprint,
                  const CameraMount& mount, std::shared_ptr<const OcclusionTable> table)
      : ExplorationGain(targets, footprint, mount, std::move(table), Options()) {}

  std::string_view name() const override { return "exploration_gain"; }
  TermTraits traits() const override;
  std::optional<ResidualForm> residual_form(const Horizon& horizon, int sign) const override;
  std::unique_ptr<TermScratch> make_scratch(const Horizon& horizon, int max_batch) const override;

  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

  void evaluate(const TrajectoryBatch& trajectories, int b, TermScratch* scratch,
                double* area) const override;
  void add_gradient(const TrajectoryBatch& trajectories, int b, TermScratch* scratch,
                    const double* adjoint, TermOutput& out) const override;

  int num_targets() const { return static_cast<int>(mass_.size()); }
  double reference_area() const { return reference_area_; }

 private:
  struct Views;
  struct Scratch;
  /// The views of one candidate: those at `place` of `looks`.
  struct Candidate {
    const Views& views;
    int place;
  };
  /// The views of candidate b, with derivatives if `gradient`: shared where that can be, else in
  /// the scratch.
  Candidate view(const TrajectoryBatch& t, int b, bool gradient, Scratch& s) const;
  /// The targets that can be seen from a pose, by any sensor: as FootprintVisibility::view().
  int look(const Pose& pose, Scratch& s, const FootprintVisibility::Views& views) const;
  /// Turns v and its derivatives into q and its own (see above), of n looks.
  void discount(const FootprintVisibility::Views& at, int n) const;
  /// s.area[k] = sum_c m_c p_ck prod_{j<k} (1 - p_cj) with p_ck = eta q_ck e^{-t_k / tau}, and what
  /// add_adjoint() needs of it. False if a pose is not finite.
  bool accumulate(const TrajectoryBatch& t, Candidate candidate, double tau, Scratch& s) const;
  /// After accumulate(), looks with derivatives.
  void write_residuals(const TrajectoryBatch& t, Candidate candidate, const Scratch& s,
                       TermOutput& out) const;
  /// Adds scale d/dx sum_k adjoint[k] s.area[k]. After accumulate(), looks with derivatives.
  void add_adjoint(const TrajectoryBatch& t, int b, Candidate candidate, const double* adjoint,
                   double scale, Scratch& s, TermOutput& out) const;

  std::vector<FootprintVisibility> visibility_;  // a sensor each
  Eigen::ArrayXd mass_;
  Eigen::ArrayXd seen_;  // v_c0
  double reference_area_;
  Options options_;
};

}  // namespace prospect
