// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "models/camera.h"
#include "perception/fusion/scale_agreement.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

struct DepthAgreementOptions {
  DepthRange range;    ///< of depths that are believed [m]
  double edge = 0.04;  ///< share by which the pixels around may differ: farther is an edge
  ScaleAgreementOptions agreement = {.least_samples = 20};
};

/// Stereo depths against those of a depth camera on the same body, at the same time.
///
/// Each point Y, in the stereo pair's left camera C, is projected into the depth camera D; the
/// depth z there, where the 3 x 3 pixels around are all valid and of one surface, is the point
/// X = T_CD (z ray); the sample is ln(Y.z / X.z).
///
/// What it finds. A baseline too large by a factor moves every point along its ray by that factor,
/// whatever the two cameras' places, as long as surfaces are smooth where a wrong depth shifts the
/// projection; the median takes care of the rest. A focal length too large by a factor stretches
/// the world along the optical axis alone: that is the same factor on surfaces across the axis, but
/// a floor or a wall along it is mapped onto itself, so it is found where the cameras face a wall,
/// and may be missed in a corridor.
///
/// relative_sigma: standard deviation of what all stereo depths may be off by together, as a share
/// of the depth at 1 m [1/m]: sigma / (f b) for errors of the disparity, of its zero or by cameras
/// out of step. No state; never throws; an image that is not whole gives no samples.
ScaleAgreement depth_agreement(const std::vector<Eigen::Vector3d>& points_in_C,
                               double relative_sigma, const PinholeCamera& depth_camera,
                               const Eigen::Isometry3d& T_CD, const DepthImage& depth,
                               const DepthAgreementOptions& options = {});

}  // namespace prospect
