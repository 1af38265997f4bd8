// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace prospect {

/// A text file that grows row by row, where a reader finds whole rows only, whenever the writer is
/// killed: each row goes to the operating system in one write and nothing waits in this process. A
/// row that does not fit (disk full) is taken back, so that the next one starts on a line of its
/// own.
class RowFile {
 public:
  enum class Begin { kEmpty, kAsItIs };
  RowFile() = default;
  /// Creates the file, and empties it or not; see is_open(). Of a symbolic link it is not open.
  explicit RowFile(const std::string& path, Begin begin = Begin::kEmpty);
  ~RowFile();
  RowFile(RowFile&& other) noexcept;
  RowFile& operator=(RowFile&& other) noexcept;

  bool is_open() const { return descriptor_ >= 0; }
  /// Appends text that ends in a newline. False if it could not be written; errno says why.
  bool append(std::string_view rows);

 private:
  int descriptor_ = -1;
};

}  // namespace prospect
