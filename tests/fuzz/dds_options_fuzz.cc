// SPDX-License-Identifier: Apache-2.0
// A file of topics of ROS 2.
#include "adapters/robots/dds/dds_options.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::folder().write("robot.yaml", fuzz::text_of(data, size));
  fuzz::read_or_refuse([&] { read_dds_options(path); });
  return 0;
}
