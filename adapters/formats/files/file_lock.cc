// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace prospect {

FileLock::FileLock(const std::string& path)
    : descriptor_(open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666)) {
  if (held() && flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const int error = errno;
  // A file system without locks: there is nothing to hold, and nobody to be kept out.
  if (held() && (error == ENOSYS || error == EOPNOTSUPP || error == ENOLCK)) return;
  busy_ = held() && error == EWOULDBLOCK;
  reason_ = std::strerror(error);
  if (held()) close(std::exchange(descriptor_, -1));
}

FileLock::~FileLock() {
  if (held()) close(descriptor_);
}

FileLock::FileLock(FileLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      busy_(other.busy_),
      reason_(std::move(other.reason_)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(busy_, other.busy_);
  std::swap(reason_, other.reason_);
  return *this;
}

}  // namespace prospect
