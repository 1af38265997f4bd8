// SPDX-License-Identifier: Apache-2.0
// A cloud of points, of the kind that the first byte says, and the world that it makes.
#include "adapters/formats/worlds/cloud_world.h"
#include "adapters/formats/worlds/point_cloud_file.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string bytes(fuzz::text_of(data, size).substr(1));
  const char* const name = data[0] % 2 == 0 ? "a.pcd" : "a.ply";
  fuzz::read_or_refuse([&] {
    CloudWorldOptions options;
    options.max_voxels = 1'000'000;  // so that an input takes little time
    options.unknown_is_free = data[0] % 4 >= 2;
    world_from_cloud(parse_point_cloud(bytes, name), name, options);
  });
  return 0;
}
