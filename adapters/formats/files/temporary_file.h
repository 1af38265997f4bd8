// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace prospect {

/// A file in the folder for temporary files (TMPDIR), removed with this object, or by
/// remove_temporary_files(); who has opened it keeps it. Thread-safety: one thread an object.
class TemporaryFile {
 public:
  /// purpose: what there must be room for, in messages: "to decompress a bag". The file's name
  /// begins with `name`. Throws InputError if it cannot be made.
  TemporaryFile(const std::string& name, std::string purpose);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  /// Throws InputError if there is no room.
  void append(std::string_view bytes);
  const std::string& path() const { return path_; }

 private:
  [[noreturn]] void no_room() const;

  std::string path_, purpose_;
  int descriptor_ = -1;
};

/// Removes those of this process that are there, for who ends it without their destructors. Safe in
/// a signal's handler.
void remove_temporary_files() noexcept;

}  // namespace prospect
