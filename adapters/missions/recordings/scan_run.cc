// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/scan_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "adapters/formats/datasets/elements.h"
#include "adapters/missions/recordings/recording_pipeline.h"
#include "adapters/missions/recordings/recording_range.h"
#include "engine/support/stopwatch.h"

namespace prospect {
namespace {

constexpr double kLowest = 0.05, kHighest = 2.4;  // of a lidar that the poses place [m]
constexpr double kAssumedHeight = 0.2;            // [m]

}  // namespace

ScanPlacement place_scans(const ScanSource& source, double height, int first) {
  ScanPlacement placement;
  const double z = source.poses.at(static_cast<std::size_t>(first)).translation().z();
  char line[200];
  if (height > 0.0) {
    placement.height = height;
    placement.T_WD.translation().z() = height - z;
  } else if (z >= kLowest && z <= kHighest) {
    placement.height = z;
    std::snprintf(line, sizeof line, "floor taken as z = 0 of %s: the lidar is %.2f m above it",
                  source.fixed.c_str(), z);
    placement.notes.emplace_back(line);
  } else if (source.planar) {
    placement.height = kAssumedHeight;
    placement.T_WD.translation().z() = kAssumedHeight - z;
    std::snprintf(line, sizeof line,
                  "the lidar's height is not known (%.2f m by %s): taken as %.1f m; --lidar-height "
                  "states it",
                  z, source.fixed.c_str(), kAssumedHeight);
    placement.notes.emplace_back(line);
  } else {
    std::snprintf(line, sizeof line, "%.2f m", z);
    throw InputError(source.from + ": the lidar is " + line + " above z = 0 of " + source.fixed +
                     ", so where the floor is is not known; expected --lidar-height");
  }
  return placement;
}

MapRun run_scan_mapping(const ScanSource& source, const ScanPlacement& placement,
                        const ScanRunOptions& options, int first, int max_scans,
                        const MapRunWatch& watch) {
  MapRun run;
  run.T_WD = placement.T_WD;
  const int n = frames_from(first, max_scans, static_cast<int>(source.stamps.size()));
  ScanMapperOptions mapping = options.mapper;
  if (source.planar) {
    HeightSlice& slice = mapping.map.slice;
    const double r = mapping.map.resolution;
    const double layer = (std::floor(placement.height / r + 1e-9) + 0.5) * r;
    slice.z_min = std::min(slice.z_min, layer);
    slice.z_max = std::max(slice.z_max, layer);
  }
  PerceptionOptions options_of_all =
      recording_options(n > 0 ? run.T_WD * source.poses[static_cast<std::size_t>(first)]
                              : Eigen::Isometry3d::Identity(),
                        options.loops);
  options_of_all.mapping = mapping.map;
  options_of_all.scan_mapping = mapping;
  options_of_all.movers = options.movers;
  PerceptionPipeline perception(options_of_all);
  PoseDrift drift;
  Elements scans("scans");
  for (int i = first; i < first + n; ++i) {
    run.cancelled = watch.cancelled && watch.cancelled();
    if (run.cancelled) break;
    const auto k = static_cast<std::size_t>(i);
    MapRunFrame frame;
    const double stamp = source.stamps[k];
    DepthScan scan;
    if (scans.read([&] { scan = source.read(k); })) {
      const Eigen::Isometry3d T_WC = run.T_WD * source.poses[k];
      frame = map_at(perception, stamp, &T_WC, drift, [&] { return perception.scan(stamp, scan); });
    } else {
      frame.mapped.stamp = stamp;
      frame.mapped.state = Mapping::kRejected;
      frame.mapped.reason = scans.why();
    }
    frame.height_error = std::numeric_limits<double>::quiet_NaN();
    ProcessorStopwatch stopwatch;
    run.maps = perception.map().snapshot();
    frame.snapshot = stopwatch.lap();
    run.frames.push_back(frame);
    if (watch.progress) watch.progress(i - first + 1, frame);
  }
  straighten(perception, run);
  if (scans.bad() > 0) run.notes.push_back(scans.note());
  if (run.cancelled) run.notes.push_back(cancelled_note(run.frames.size(), n));
  return run;
}

}  // namespace prospect
