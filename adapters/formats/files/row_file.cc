// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/row_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace prospect {

RowFile::RowFile(const std::string& path, Begin begin)
    : descriptor_(open(path.c_str(),
                       O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW |
                           (begin == Begin::kEmpty ? O_TRUNC : 0),
                       0666)) {}

RowFile::~RowFile() {
  if (is_open()) close(descriptor_);
}

RowFile::RowFile(RowFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

RowFile& RowFile::operator=(RowFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

bool RowFile::append(std::string_view rows) {
  if (!is_open()) {
    errno = EBADF;
    return false;
  }
  const off_t start = lseek(descriptor_, 0, SEEK_END);
  std::size_t done = 0;
  while (done < rows.size()) {
    const ssize_t count = write(descriptor_, rows.data() + done, rows.size() - done);
    if (count >= 0) {
      done += static_cast<std::size_t>(count);
      continue;
    }
    if (errno == EINTR) continue;
    const int reason = errno;
    // What cannot be taken back (not a regular file) is no file that a row could be left in.
    if (start >= 0 && ftruncate(descriptor_, start) != 0) errno = reason;
    errno = reason;
    return false;
  }
  return true;
}

}  // namespace prospect
