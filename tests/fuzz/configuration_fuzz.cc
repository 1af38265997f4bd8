// SPDX-License-Identifier: Apache-2.0
// A configuration.
#include "adapters/missions/config/configuration.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  fuzz::read_or_refuse([&] { configuration_from_text(std::string(bytes), "robot.yaml"); });
  return 0;
}
