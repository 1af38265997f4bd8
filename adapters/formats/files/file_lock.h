// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect {

/// A file that one process at a time may hold: flock(), which the operating system ends with the
/// process, however that ends. Held until this object is gone. Movable. Not thread-safe.
class FileLock {
 public:
  FileLock() = default;
  /// Makes the file if it is not there, and leaves what it holds. See held() and reason().
  explicit FileLock(const std::string& path);
  ~FileLock();
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;

  bool held() const { return descriptor_ >= 0; }
  /// Of the file, closed by exec(): a process that is to hold it, too, keeps its copy open.
  int descriptor() const { return descriptor_; }
  /// Another process, or another object of this one, holds it.
  bool busy() const { return busy_; }
  /// Why it is not held, in words.
  const std::string& reason() const { return reason_; }

 private:
  int descriptor_ = -1;
  bool busy_ = false;
  std::string reason_;
};

}  // namespace prospect
