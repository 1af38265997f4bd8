// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/output_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/whole_file.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kProgram = "prospect ", kFile = "file ", kFolder = "folder ";
constexpr std::string_view kBegun = "begun", kComplete = "complete", kRemoved = "removed";

/// "runs/a/" and "runs/a/." are "runs/a": of "link/" the system says what the link leads to.
fs::path without_slash(const std::string& path) {
  fs::path name = path;
  while ((name.filename().empty() || name.filename() == ".") && name.has_parent_path() &&
         name != name.root_path()) {
    name = name.parent_path();
  }
  return name;
}

/// A name below a folder that leads nowhere else.
bool is_below(std::string_view name) {
  if (name.empty() || name.find('\n') != std::string_view::npos) return false;
  const fs::path path(name);
  return path.is_relative() && std::none_of(path.begin(), path.end(), [](const fs::path& part) {
           return part == ".." || part == "." || part.empty();
         });
}

bool is_word(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= 'a' && c <= 'z'; });
}

bool has(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

/// Nothing is there but the marker.
bool is_empty_folder(const fs::path& path) {
  std::error_code error;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().filename() != OutputFolder::kMarker) return false;
  }
  if (error) {
    fail(path.string(), "cannot be read (" + error.message() + "); expected a readable folder");
  }
  return true;
}

}  // namespace

OutputFolder OutputFolder::own(const std::string& path, const std::vector<std::string>& kinds) {
  OutputFolder folder(path, kinds, Others::kRefused);
  folder.lock_ = FileLock(folder.file(kMarker));
  if (folder.lock_.busy()) {
    fail(path, "another run writes to it; expected a folder of its own (--out)");
  }
  if (!folder.lock_.held()) {
    const std::string reason = folder.lock_.reason();
    if (folder.fresh_) folder.abandon();
    fail(folder.file(kMarker), "cannot be written (" + reason + "); expected a writable folder");
  }
  folder.read_marker();  // as it is now that nobody else writes it
  folder.fresh_ = folder.kind_.empty();
  folder.open_marker();
  return folder;
}

OutputFolder OutputFolder::shared(const std::string& path, const std::vector<std::string>& kinds) {
  OutputFolder folder(path, kinds, Others::kRefused);
  folder.open_marker();
  return folder;
}

OutputFolder OutputFolder::beside(const std::string& path) {
  OutputFolder folder(path.empty() ? "." : path, {"files"}, Others::kAllowed);
  folder.open_marker();
  return folder;
}

OutputFolder::OutputFolder(const std::string& path, const std::vector<std::string>& kinds,
                           Others others)
    : path_(path),
      expected_("; expected a new or empty folder, or one of an earlier " + kinds.front()),
      own_kind_(kinds.front()) {
  const fs::path name = without_slash(path);
  std::error_code error;
  const fs::file_status status = fs::symlink_status(name, error);
  const bool link = fs::is_symlink(status);
  if (link && others == Others::kRefused) fail(path, "is a symbolic link" + expected_);
  const bool folder = link ? fs::is_directory(name, error) : fs::is_directory(status);
  if (fs::exists(status) && !folder) fail(path, "is no folder" + expected_);
  if (!fs::exists(status)) {
    for (fs::path missing = name; !missing.empty() && !fs::exists(missing, error);
         missing = missing.parent_path()) {
      made_.insert(made_.begin(), missing.string());
    }
    if (fs::create_directories(name, error); error) {
      fail(path, "cannot be created (" + error.message() + "); expected a writable place");
    }
  }
  read_marker();
  fresh_ = kind_.empty();
  if (others == Others::kAllowed) return;
  if (kind_.empty() && made_.empty() && !is_empty_folder(name)) {
    refuse_others("holds other files");
  }
  if (!kind_.empty() && !has(kinds, kind_))
    refuse_others("holds what is of another kind: " + kind_);
}

OutputFolder::~OutputFolder() {
  if (!fresh_ || !marker_.is_open()) return;
  try {
    read_marker();  // others may have added to it
    std::error_code error;
    const bool holds =
        state_ != State::kNew ||
        std::any_of(named_folders_.begin(), named_folders_.end(),
                    [&](const std::string& f) { return fs::exists(file(f), error); });
    if (!holds) abandon();
  } catch (const std::exception&) {
    // What cannot be read stays.
  }
}

void OutputFolder::refuse_others(const std::string& what) const {
  fail(path_, what + expected_ + " (which has a file " + kMarker + ")");
}

std::string OutputFolder::file(const std::string& name) const {
  return (fs::path(path_) / name).string();
}

bool OutputFolder::names(const std::string& name) const {
  return has(named_, name) ||
         std::any_of(named_folders_.begin(), named_folders_.end(), [&](const std::string& folder) {
           return name == folder || name.starts_with(folder + '/');
         });
}

void OutputFolder::read_marker() {
  kind_.clear();
  named_.clear();
  named_folders_.clear();
  complete_ = false;
  state_ = State::kNew;
  const std::string path = file(kMarker);
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (!fs::exists(status)) return;
  if (!fs::is_regular_file(status)) fail_marker("is no regular file");
  std::ifstream in(path, std::ios::binary);
  std::string line;
  // A last line without its end was cut off.
  for (int count = 1; std::getline(in, line) && !in.eof(); ++count) read_line(line, count);
  const bool holds = std::any_of(named_.begin(), named_.end(), [&](const std::string& name) {
    return fs::exists(fs::symlink_status(file(name), error));
  });
  state_ = !holds ? State::kNew : complete_ ? State::kComplete : State::kBegun;
}

void OutputFolder::read_line(std::string_view line, int count) {
  const auto value = [&](std::string_view word) {
    return line.starts_with(word) ? line.substr(word.size()) : std::string_view();
  };
  if (is_word(value(kProgram))) {
    kind_ = value(kProgram);
  } else if (kind_.empty()) {
    fail_marker("line " + std::to_string(count) + " names no kind");
  } else if (is_below(value(kFile))) {
    named_.emplace_back(value(kFile));
  } else if (is_below(value(kFolder))) {
    named_folders_.emplace_back(value(kFolder));
  } else if (line == kBegun || line == kComplete) {
    complete_ = line == kComplete;
  } else if (line == kRemoved) {
    named_.clear();
  } else {
    fail_marker("line " + std::to_string(count) + " is '" + std::string(line) + "'");
  }
}

void OutputFolder::fail_marker(const std::string& what) const {
  fail(file(kMarker), what + "; expected it as the program writes it");
}

void OutputFolder::open_marker() {
  marker_ = RowFile(file(kMarker), RowFile::Begin::kAsItIs);
  if (marker_.is_open() && (!fresh_ || marker_.append(std::string(kProgram) + own_kind_ + '\n'))) {
    return;
  }
  const std::string reason = std::strerror(errno);
  if (fresh_) abandon();
  fail(file(kMarker), "cannot be written (" + reason + "); expected a writable folder");
}

void OutputFolder::check(const std::string& name, bool folder) const {
  std::error_code error;
  for (fs::path above = fs::path(name).parent_path(); !above.empty(); above = above.parent_path()) {
    const fs::file_status status = fs::symlink_status(file(above.string()), error);
    if (fs::exists(status) && !fs::is_directory(status)) {
      fail(file(above.string()), "is no folder; expected one, or nothing");
    }
  }
  const auto there = [&](const std::string& path) { return fs::symlink_status(file(path), error); };
  const std::string part = name + kPart;
  for (const std::string& path : {name, part}) {
    if (folder && path == part) continue;
    const fs::file_status status = there(path);
    if (!fs::exists(status)) continue;
    if (!names(name)) {
      fail(file(path), std::string("is there, and not named in ") + kMarker +
                           " as this program's; expected another folder");
    }
    if (folder ? !fs::is_directory(status) : !fs::is_regular_file(status)) {
      fail(file(path), std::string("is no ") + (folder ? "folder" : "regular file") +
                           "; expected one, or nothing");
    }
  }
}

void OutputFolder::add(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  if (text.empty() || marker_.append(text)) return;
  fail(file(kMarker),
       std::string("cannot be written (") + std::strerror(errno) + "); expected a writable folder");
}

void OutputFolder::claim_all(const std::vector<std::string>& names_of_files) {
  for (const std::string& name : names_of_files) check(name, false);
  std::vector<std::string> lines;
  for (const std::string& name : names_of_files) {
    if (!names(name)) lines.push_back(std::string(kFile) + name);
  }
  add(lines);
  for (const std::string& name : names_of_files) {
    if (!names(name)) named_.push_back(name);
    const fs::path above = fs::path(name).parent_path();
    std::error_code error;
    if (above.empty()) continue;
    if (fs::create_directories(file(above.string()), error); error) {
      fail(file(above.string()),
           "cannot be created (" + error.message() + "); expected a writable folder");
    }
  }
}

std::string OutputFolder::claim(const std::string& name) {
  claim_all({name});
  return file(name);
}

std::string OutputFolder::claim_folder(const std::string& name) {
  check(name, true);
  if (!names(name)) {
    add({std::string(kFolder) + name});
    named_folders_.push_back(name);
  }
  std::error_code error;
  if (fs::create_directories(file(name), error); error) {
    fail(file(name), "cannot be created (" + error.message() + "); expected a writable folder");
  }
  return file(name);
}

std::string OutputFolder::write(const std::string& name, const std::string& content) {
  return write_whole_file(claim(name), content);
}

void OutputFolder::remove_named(const std::vector<std::string>& kept) {
  std::error_code ignored;
  for (const std::string& name : named_) {
    if (has(kept, name)) continue;
    fs::remove(file(name), ignored);
    fs::remove(file(name + kPart), ignored);
    for (fs::path above = fs::path(name).parent_path(); !above.empty();
         above = above.parent_path()) {
      if (!fs::remove(file(above.string()), ignored)) break;  // if it is empty
    }
  }
}

void OutputFolder::begin(const std::vector<std::string>& names_of_files,
                         const std::vector<std::string>& kept) {
  for (const std::string& name : names_of_files) check(name, false);
  for (const std::string& name : named_) check(name, false);
  add({std::string(kBegun)});  // first: what is left is not whole any more
  remove_named(kept);
  std::erase_if(named_, [&](const std::string& name) { return !has(kept, name); });
  std::vector<std::string> lines = {std::string(kRemoved), std::string(kProgram) + own_kind_};
  for (const std::string& name : named_) lines.push_back(std::string(kFile) + name);
  add(lines);
  kind_ = own_kind_;
  claim_all(names_of_files);
}

std::string OutputFolder::complete() {
  return marker_.append(std::string(kComplete) + '\n') ? "" : std::strerror(errno);
}

void OutputFolder::abandon() {
  std::error_code ignored;
  remove_named({});
  named_.clear();
  if (!fresh_) {
    marker_.append(std::string(kRemoved) + '\n');
    return;
  }
  fs::remove(file(kMarker), ignored);
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) fs::remove(*folder, ignored);
  fresh_ = false;
}

}  // namespace prospect
