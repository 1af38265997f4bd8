#include "adapters/files/whole_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace prospect {

std::string write_whole_file(const std::string& path, const std::string& content) {
  namespace fs = std::filesystem;
  const std::string temporary = path + ".part";
  errno = 0;
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  file << content;
  file.close();
  const int reason = errno;
  std::error_code error, ignored;
  if (!file) {
    fs::remove(temporary, ignored);
    return reason ? std::strerror(reason) : "unknown reason";
  }
  fs::rename(temporary, path, error);
  if (error) fs::remove(temporary, ignored);
  return error ? error.message() : "";
}

}  // namespace prospect
