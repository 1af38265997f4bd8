// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "adapters/formats/files/file_lock.h"
#include "adapters/formats/files/row_file.h"

namespace prospect {

/// A folder that a command writes. A file in it, `.prospect`, says so. It is written before
/// anything else, and names what the program has written there, a line each:
///
///     prospect bench           what wrote it: a word
///     file figures/gap.svg     before that file is written
///     folder cells             all that is in it
///     begun, complete          the last one counts: whether what it holds is whole
///     removed                  of the files named so far none is left
///
/// It only ever grows, so that a kill at any moment leaves one that holds.
/// What it does not name is somebody else's: it is neither replaced nor removed. Symbolic links are
/// not followed: not the folder, not a folder in it, not a file. Parents of the folder may be
/// links.
///
/// A folder that was made, or empty, and in which nothing has been written until this object is
/// gone, is left as it was.
///
/// Thread-safety: one thread. Errors: InputError in one line, before anything in the folder has
/// changed.
class OutputFolder {
 public:
  static constexpr const char* kMarker = ".prospect";
  enum class State {
    kNew,      ///< it holds nothing of the program yet
    kBegun,    ///< what it holds was broken off, or is being written
    kComplete  ///< what it holds is whole
  };

  OutputFolder() = default;
  ~OutputFolder();
  OutputFolder(OutputFolder&&) = default;
  OutputFolder& operator=(OutputFolder&&) = default;

  /// For one command at a time: made if it is not there, and locked until this object is gone. One
  /// that is there must be empty, or of one of `kinds`, of which the first is what it becomes.
  static OutputFolder own(const std::string& path, const std::vector<std::string>& kinds);
  /// For commands that add to what others have written, at the same time, too: like own(), but not
  /// locked.
  static OutputFolder shared(const std::string& path, const std::vector<std::string>& kinds);
  /// For single files beside those of others: any folder.
  static OutputFolder beside(const std::string& path);

  const std::string& path() const { return path_; }
  /// What was there when it was opened.
  State state() const { return state_; }
  const std::string& kind() const { return kind_; }

  /// Names files as the program's own, before they are written. Throws InputError if one is there
  /// that is somebody else's, or no regular file. Makes the folders that they are in.
  void claim_all(const std::vector<std::string>& names);
  /// The same of one, and its path.
  std::string claim(const std::string& name);
  /// The same of a folder in it, with all that it holds.
  std::string claim_folder(const std::string& name);
  /// Claims a file and writes it whole (write_whole_file()). Returns "" or why it could not be
  /// written, in words.
  std::string write(const std::string& name, const std::string& content);

  /// Removes what an earlier command left, but for `kept`, and claims `names`. Only of own().
  void begin(const std::vector<std::string>& names, const std::vector<std::string>& kept = {});
  /// Says that what it holds is whole. Returns "" or why that could not be written, in words.
  std::string complete();
  /// Removes what it names; and its marker and the folders that were made for it, unless it was
  /// the program's before. Never throws.
  void abandon();

 private:
  enum class Others { kRefused, kAllowed };
  OutputFolder(const std::string& path, const std::vector<std::string>& kinds, Others others);
  void read_marker();
  void read_line(std::string_view line, int count);
  void check(const std::string& name, bool folder) const;
  void add(const std::vector<std::string>& lines);
  void open_marker();
  bool names(const std::string& name) const;
  std::string file(const std::string& name) const;
  [[noreturn]] void fail_marker(const std::string& what) const;
  [[noreturn]] void refuse_others(const std::string& what) const;
  void remove_named(const std::vector<std::string>& kept);

  std::string path_;
  std::string expected_;            // what a folder may be, for errors
  std::vector<std::string> made_;   // folders, the outermost first
  std::vector<std::string> named_;  // files
  std::vector<std::string> named_folders_;
  std::string kind_, own_kind_;
  bool complete_ = false;
  bool fresh_ = false;  // it was none of the program's before
  State state_ = State::kNew;
  FileLock lock_;
  RowFile marker_;
};

}  // namespace prospect
