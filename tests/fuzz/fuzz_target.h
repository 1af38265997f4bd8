// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "adapters/formats/files/input_error.h"

/// One input; a fuzzing target defines it, libFuzzer or plain_driver.cc calls it. It returns 0, or
/// the process ends: that is a finding.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace prospect::fuzz {

/// A folder of this process, in memory where there is one for that, which goes with it.
class Folder {
 public:
  Folder() {
    namespace fs = std::filesystem;
    const fs::path memory = "/dev/shm";
    path_ = (fs::exists(memory) ? memory : fs::temp_directory_path()) /
            ("prospect_fuzz_" + std::to_string(::getpid()));
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  /// Writes a file and returns its path.
  std::string write(const std::string& name, std::string_view bytes) const {
    const std::string path = (path_ / name).string();
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path;
  }

 private:
  std::filesystem::path path_;
};

/// The folder of the target.
inline const Folder& folder() {
  static const Folder kFolder;
  return kFolder;
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Whether a refusal is as it has to be: lines that are not empty, without control characters, not
/// too many and not too long.
inline bool is_clear(const std::string& what) {
  constexpr std::size_t kMostLines = 110, kLongest = 4000;
  std::istringstream in(what);
  std::size_t lines = 0;
  for (std::string line; std::getline(in, line); ++lines) {
    const bool printable = std::none_of(line.begin(), line.end(), [](char c) {
      return static_cast<unsigned char>(c) < 0x20 && c != '\t';
    });
    if (line.empty() || line.size() > kLongest || !printable) return false;
  }
  return lines >= 1 && lines <= kMostLines;
}

/// Runs a loader: it returns, or throws InputError. Of those that throw std::invalid_argument
/// instead, say so by `Refusal`.
template <typename Refusal = InputError, typename Read>
void read_or_refuse(const Read& read) {
  try {
    read();
  } catch (const Refusal& refusal) {
    if (is_clear(refusal.what())) return;
    std::fprintf(stderr, "a refusal that is no clear line: '%s'\n", refusal.what());
    std::abort();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "an exception that is no refusal: %s\n", error.what());
    std::abort();
  }
}

}  // namespace prospect::fuzz
