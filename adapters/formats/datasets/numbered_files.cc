// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/numbered_files.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>

#include "adapters/formats/files/input_error.h"

namespace prospect {

namespace fs = std::filesystem;

std::vector<std::pair<std::uint64_t, std::string>> numbered_files(const std::string& folder,
                                                                  const std::string& prefix,
                                                                  const std::string& suffix) {
  std::error_code error;
  const std::string expected = "expected " + prefix + "NUMBER" + suffix;
  if (!fs::is_directory(folder, error)) {
    throw InputError(folder + ": no such folder; expected one with numbered " + suffix + " images");
  }
  std::vector<std::pair<std::uint64_t, std::string>> files;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name[0] == '.' || !name.ends_with(suffix)) continue;
    const bool named = name.starts_with(prefix) && name.size() > prefix.size() + suffix.size();
    const std::string digits =
        named ? name.substr(prefix.size(), name.size() - prefix.size() - suffix.size()) : "";
    if (digits.empty() || digits.size() > 19 ||
        !std::all_of(digits.begin(), digits.end(),
                     [](unsigned char c) { return std::isdigit(c); })) {
      throw InputError(entry.path().string() + ": the name is no number; " + expected);
    }
    files.emplace_back(std::stoull(digits), entry.path().string());
  }
  if (files.empty()) throw InputError(folder + ": holds no image; " + expected);
  std::sort(files.begin(), files.end());
  return files;
}

std::string read_whole_file(const std::string& path) {
  std::ifstream file(path);
  if (!file || fs::is_directory(path)) throw InputError(path + ": cannot be read; expected a file");
  std::ostringstream out;
  out << file.rdbuf();
  std::string text = std::move(out).str();
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // editors of Windows put it there
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

}  // namespace prospect
