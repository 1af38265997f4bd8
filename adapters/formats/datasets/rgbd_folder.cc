// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/rgbd_folder.h"

#include <filesystem>

namespace prospect {

bool is_rgbd_folder(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  for (const char* name : {"rgb.txt", "depth.txt", "associations.txt", "depth"}) {
    if (fs::exists(path + "/" + name, error)) return true;
  }
  for (const auto& entry : fs::directory_iterator(path, error)) {
    if (entry.path().filename().string().ends_with(".depth.png")) return true;
  }
  return false;
}

}  // namespace prospect
