// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "perception/mapping/depth_mapper.h"
#include "perception/mapping/stereo_depth.h"

namespace prospect {

/// Whether a recording is mapped by the depth of its stereo pair: it holds one, and neither depth
/// images nor scans; or it is a bag in which "left" is chosen. Throws InputError if the bag cannot
/// be read.
bool is_used_for_stereo_depth(const std::string& path,
                              const std::map<std::string, std::string>& topics);

/// A recording of a stereo pair as one of depth images: those of the rectified left camera, made
/// when they are read (perception/mapping/stereo_depth.h).
///
/// Poses: the recording's own at the time of each frame, between neighbours at most 0.25 s apart;
/// where it has none, those of the visual odometry (odometry_run.h), which goes over the whole
/// recording first. A frame without a pose is left out and counted: of the odometry one that is
/// lost or degraded, and all from where it began anew after a loss, as nothing tells how the camera
/// moved meanwhile.
///
/// Throws InputError as StereoDataset::open(), and where no frame has a pose. Reading: one thread
/// at a time; memory does not grow with the recording, but for stamps and poses. Deterministic.
DepthSource open_stereo_depth(const std::string& path, const StereoDatasetOptions& options = {},
                              const StereoDepthOptions& depth = {});

/// The depth at which two of its standard deviations are a voxel of that side [m]: farther away the
/// surfaces of a map are blurred.
double sharp_range(const StereoDepthAccuracy& stereo, double resolution);

/// Sets what the noise of such depths asks of a mapper that learns as far as `range` [m]: the
/// depths that it believes, how it tells floor from obstacles, and where it enters hits.
void set_stereo_accuracy(const StereoDepthAccuracy& stereo, double range,
                         DepthMapperOptions& mapper);

}  // namespace prospect
