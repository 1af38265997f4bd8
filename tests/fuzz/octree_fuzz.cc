// SPDX-License-Identifier: Apache-2.0
// An octree, .bt or .ot, and the world that it makes.
#include <octomap/OcTree.h>

#include "adapters/formats/worlds/octree_file.h"
#include "adapters/formats/worlds/octree_world.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  fuzz::read_or_refuse([&] {
    OctreeLimits limits;
    limits.max_nodes = 1'000'000;  // so that an input takes little time
    const auto tree = parse_octree(bytes, "a.bt", limits);
    world_from_octree(*tree, "a.bt", {});
  });
  return 0;
}
