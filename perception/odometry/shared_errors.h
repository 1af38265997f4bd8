// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace prospect {

class Knobs;
struct ObservationResidual;
struct PointObservation;
struct Track;

/// What errors of tracked positions share. An error is not new in every frame: the patch of a
/// landmark is seen under a light and from a side that hardly change, neighbours lie on one
/// surface, and all are warped by one motion. Nor is it new with every keyframe: the landmarks that
/// follow lie on the same surfaces, under the same light, and move the same way.
struct SharedErrorOptions {
  /// Of the variance that a patch's texture gives to its position: the same as long as it is
  /// tracked. The rest is new in every frame.
  double lasting = 0.9;
  /// Of what lasts: shared by all landmarks that are seen in one of 6 x 6 parts of the image, and
  /// by all of the image, whatever keyframe made them. The rest is the landmark's own.
  double area = 0.2, image = 0.05;
  /// Correlation of what an area or the image shares with the same at the next keyframe.
  double memory = 0.9;
  /// Correlation of a patch's errors in the left and in the right image, along the rows.
  double left_right = 0.89;
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, SharedErrorOptions& options);

/// Errors of one observation (u, v, u_right) [px], given what the anchor measured m:
///   sum_k L_k x_k + n,   x_k of three independent numbers of variance 1, n ~ N(0, fresh).
/// What the anchor measured is part of what lasts: it moves the landmark the same way in all frames
/// that see it from one side, and neighbours share it as well. With T the covariance that the
/// texture gives,
///   sum_k L_k L_k^T = dr/dm M dr/dm^T + lasting T.
struct ObservationErrors {
  Eigen::Matrix3d landmark, area, image;  ///< L of what each of them shares
  Eigen::Matrix3d fresh;
};
ObservationErrors observation_errors(const PointObservation& observation,
                                     const ObservationResidual& residual, double sigma_left,
                                     double sigma_right, const SharedErrorOptions& options);

/// Numbers of these errors (pose_drift.h) of a track, where it is seen now; `width`, `height` of
/// the image [px].
struct ErrorNumbers {
  std::uint64_t landmark, area, image;
};
ErrorNumbers error_numbers(const Track& track, double width, double height);
/// Of all areas and of the image, ascending: what outlives keyframes.
const std::vector<std::uint64_t>& numbers_of_areas();

}  // namespace prospect
