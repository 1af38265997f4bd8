// SPDX-License-Identifier: Apache-2.0
// What is looked at in a mesh before the library reads it, of the kind that the first byte says.
#include "adapters/formats/worlds/gltf_check.h"
#include "adapters/formats/worlds/mesh_check.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  if (size == 0) return 0;
  const std::string_view mesh = bytes.substr(1);
  fuzz::read_or_refuse([&] {
    LeftOut left_out;
    switch (data[0] % 4) {
      case 0:
        return check_stl(mesh, "a.stl");
      case 1:
        return check_ply(mesh, "a.ply");
      case 2:
        return check_collada(mesh, "a.dae");
      default:
        return check_gltf(mesh, "a.gltf", left_out);
    }
  });
  return 0;
}
