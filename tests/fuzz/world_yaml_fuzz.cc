// SPDX-License-Identifier: Apache-2.0
// A world file.
#include "adapters/formats/worlds/world_file.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  fuzz::read_or_refuse([&] { world_from_yaml(std::string(bytes), "world.yaml"); });
  return 0;
}
