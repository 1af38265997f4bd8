// SPDX-License-Identifier: Apache-2.0
// A bare image: PGM, PNG or BMP; the first byte says by which name.
#include "adapters/formats/worlds/ros_map.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  if (size == 0) return 0;
  constexpr const char* kNames[] = {"a.pgm", "a.png", "a.bmp"};
  const std::string path = fuzz::folder().write(kNames[data[0] % 3], bytes.substr(1));
  fuzz::read_or_refuse([&] { world_from_image(path); });
  return 0;
}
