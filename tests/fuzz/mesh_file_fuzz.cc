// SPDX-License-Identifier: Apache-2.0
// A mesh, of the kind that the first byte says, through the child process and into voxels.
#include "adapters/formats/worlds/mesh_file.h"
#include "adapters/formats/worlds/mesh_world.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  if (size == 0) return 0;
  constexpr const char* kNames[] = {"a.obj", "a.stl", "a.ply", "a.gltf", "a.glb", "a.dae"};
  const std::string path = fuzz::folder().write(kNames[data[0] % 6], bytes.substr(1));
  fuzz::read_or_refuse([&] { world_from_mesh(read_mesh_file(path), path, {}); });
  return 0;
}
