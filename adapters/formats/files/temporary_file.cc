// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/temporary_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

// A process has few at a time; of more, those past these are left where it ends without
// destructors.
std::array<std::atomic<const char*>, 16> paths{};
static_assert(std::atomic<const char*>::is_always_lock_free);

void replace_one(const char* from, const char* to) {
  for (std::atomic<const char*>& path : paths) {
    const char* expected = from;
    if (path.compare_exchange_strong(expected, to)) return;
  }
}

}  // namespace

TemporaryFile::TemporaryFile(const std::string& name, std::string purpose)
    : path_((std::filesystem::temp_directory_path() / (name + "_XXXXXX")).string()),
      purpose_(std::move(purpose)) {
  descriptor_ = ::mkostemp(path_.data(), O_CLOEXEC);
  if (descriptor_ < 0) no_room();
  replace_one(nullptr, path_.c_str());
}

TemporaryFile::~TemporaryFile() {
  ::close(descriptor_);
  ::unlink(path_.c_str());
  replace_one(path_.c_str(), nullptr);
}

void TemporaryFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) no_room();
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

void TemporaryFile::no_room() const {
  throw InputError(path_ + ": " + std::strerror(errno) + "; expected room " + purpose_ +
                   " (TMPDIR names another folder)");
}

void remove_temporary_files() noexcept {
  for (const std::atomic<const char*>& path : paths) {
    if (const char* const name = path) ::unlink(name);
  }
}

}  // namespace prospect
