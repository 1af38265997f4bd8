// SPDX-License-Identifier: Apache-2.0
// A ROS map: its .yaml, then from the first byte 0x1d on its image, map.pgm.
#include "adapters/formats/worlds/ros_map.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  const std::size_t end = std::min(bytes.find(0x1d), size);
  fuzz::folder().write("map.pgm", bytes.substr(std::min(size, end + 1)));
  const std::string path = fuzz::folder().write("map.yaml", bytes.substr(0, end));
  fuzz::read_or_refuse([&] { world_from_ros_map(path); });
  return 0;
}
