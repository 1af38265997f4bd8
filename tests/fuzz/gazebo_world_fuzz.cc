// SPDX-License-Identifier: Apache-2.0
// A Gazebo world without the files that it names.
#include "adapters/formats/worlds/gazebo_world.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  const std::string path = fuzz::folder().write("a.world", bytes);
  fuzz::read_or_refuse([&] { read_gazebo_world(path); });
  return 0;
}
