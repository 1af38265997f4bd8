// SPDX-License-Identifier: Apache-2.0
// Trajectories: TUM and KITTI.
#include "adapters/formats/datasets/trajectory.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  const std::string path = fuzz::folder().write("a.txt", bytes);
  std::vector<std::string> notes;
  fuzz::read_or_refuse([&] { read_tum_trajectory(path, notes); });
  fuzz::read_or_refuse([&] { read_kitti_poses(path, notes); });
  return 0;
}
