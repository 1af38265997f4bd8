#include "adapters/datasets/rgbd_folder.h"

#include <cctype>
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

bool is_video_name(const std::string& name) {
  const auto dot = name.rfind('.');
  if (dot == std::string::npos) return false;
  std::string ending = name.substr(dot + 1);
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* video : {"mp4", "avi", "mkv", "mov", "webm", "svo", "m4v"}) {
    if (ending == video) return true;
  }
  return false;
}

}  // namespace prospect
