// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/depth_cameras.h"

#include <cstdint>

#include "adapters/robots/simulator/noise_stream.h"
#include "models/mixed_bits.h"

namespace prospect {

std::vector<DepthCamera> depth_cameras(const World& world, const SimulatorOptions& options) {
  const std::uint64_t seed = stream_seed(options.seed, NoiseStream::kDepth);
  std::vector<DepthCamera> all;
  all.emplace_back(world, options.depth, options.depth_mount, seed);
  for (const DepthSensor& sensor : options.more_depth) {
    DepthCameraOptions rays = options.depth;
    rays.footprint = sensor.footprint;
    set_resolution(rays);
    all.emplace_back(world, rays, sensor.mount, mixed_bits(seed + all.size()));
  }
  return all;
}

}  // namespace prospect
