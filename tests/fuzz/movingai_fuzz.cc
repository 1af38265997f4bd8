// SPDX-License-Identifier: Apache-2.0
// A MovingAI grid.
#include "adapters/formats/worlds/ros_map.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  const std::string path = fuzz::folder().write("a.map", bytes);
  fuzz::read_or_refuse([&] { world_from_movingai(path); });
  return 0;
}
