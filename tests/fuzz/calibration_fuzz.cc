// SPDX-License-Identifier: Apache-2.0
// Calibrations of cameras: KITTI, ROS, OpenCV, Kalibr, by the name that the first byte says.
#include "adapters/formats/datasets/stereo_calibration.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  if (size == 0) return 0;
  constexpr const char* kNames[] = {"calib.txt", "camchain.yaml", "stereo.yml", "info.yaml"};
  const std::string path = fuzz::folder().write(kNames[data[0] % 4], bytes.substr(1));
  fuzz::read_or_refuse([&] { read_stereo_calibration(path); });
  fuzz::read_or_refuse([&] { read_stereo_calibration(path + "," + path, true); });
  std::vector<std::string> notes;
  fuzz::read_or_refuse([&] { read_camera_info_pinhole(path, notes); });
  fuzz::read_or_refuse([&] { read_kitti_calibration(path, 2); });
  return 0;
}
