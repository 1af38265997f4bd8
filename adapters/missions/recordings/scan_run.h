// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <string>
#include <vector>

#include "adapters/formats/datasets/scan_source.h"
#include "adapters/missions/recordings/map_run.h"
#include "perception/mapping/mover_tracker.h"
#include "perception/mapping/scan_mapper.h"

namespace prospect {

/// Where the floor of W is in a recording of a lidar, whose poses do not tell.
struct ScanPlacement {
  Eigen::Isometry3d T_WD =
      Eigen::Isometry3d::Identity();  ///< W from the poses' frame, z up in both
  double height = 0.0;                ///< of the lidar in the first scan [m]
  std::vector<std::string> notes;     ///< what was assumed
};

/// `height`: of the lidar above the floor in scan `first` [m]; 0: not known. Then z = 0 of the
/// poses is the floor if the lidar is 0.05 to 2.4 m above it. If it is not, 0.2 m is assumed of
/// scans of one plane, whose map does not depend on it; clouds are refused. Throws InputError, one
/// line.
ScanPlacement place_scans(const ScanSource& source, double height, int first = 0);

struct ScanRunOptions {
  ScanMapperOptions mapper;
  bool loops = false;  ///< as MapRunOptions
  MoverTrackerOptions movers{};
};

/// Maps a recording by PerceptionPipeline, from scan `first`, at most `max_scans` (0: all). The
/// result is that of run_mapping() with poses and without grounds. Of scans of one plane the slice
/// of the ground map is widened to hold the layer of voxels that the first one runs in.
///
/// A scan that cannot be read is rejected, and notes say so. Cancelled, the map is that of the
/// scans so far. One thread; the same recording gives the same bits, but for times.
MapRun run_scan_mapping(const ScanSource& source, const ScanPlacement& placement,
                        const ScanRunOptions& options = {}, int first = 0, int max_scans = 0,
                        const MapRunWatch& watch = {});

}  // namespace prospect
