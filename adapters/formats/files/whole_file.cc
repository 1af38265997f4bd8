// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/whole_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "adapters/formats/files/row_file.h"

namespace prospect {

std::string write_whole_file(const std::string& path, const std::string& content) {
  namespace fs = std::filesystem;
  const std::string temporary = path + kPart;
  std::error_code error, ignored;
  bool written = false;
  {
    RowFile file(temporary);
    if (!file.is_open()) return std::strerror(errno);
    written = file.append(content);
    if (!written) error = std::error_code(errno, std::generic_category());
  }
  if (written) fs::rename(temporary, path, error);
  if (error) fs::remove(temporary, ignored);
  return error ? error.message() : "";
}

}  // namespace prospect
