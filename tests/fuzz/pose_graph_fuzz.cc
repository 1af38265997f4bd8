// SPDX-License-Identifier: Apache-2.0
// Pose graphs in the format of g2o, and which of their edges are odometry.
#include "adapters/formats/datasets/g2o_file.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::folder().write("a.g2o", fuzz::text_of(data, size));
  fuzz::read_or_refuse([&] { poses_of(read_g2o(path)); });
  return 0;
}
