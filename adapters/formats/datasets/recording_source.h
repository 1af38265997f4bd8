// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect {

/// What a layout says of any recording, beside what it finds in it.
struct RecordingSource {
  std::string layout;
  bool times_assumed = false;
  std::vector<std::string> notes;  ///< what was assumed, chosen or passed over, one line each
  /// What keeps the recording from being used, one line each, as for InputError. It does not stop
  /// the search for the rest.
  std::vector<std::string> missing;

  /// Calls `read` and lists the lines of an InputError as missing; false then.
  template <typename Read>
  bool attempt(const Read& read) {
    try {
      read();
      return true;
    } catch (const InputError& error) {
      missing.insert(missing.end(), error.lines().begin(), error.lines().end());
      return false;
    }
  }
};

/// A layout of recordings. Each recognises itself, by looking at names alone.
template <typename Source, typename Options>
struct RecordingLayout {
  const char* name;
  const char* looked_for;  ///< for the message where no layout fits
  bool (*recognises)(const std::string& path);
  Source (*open)(const std::string& path, const Options& options);
};

/// The first layout that recognises the path; null: none does.
template <typename Layout>
const Layout* find_layout(const std::vector<Layout>& layouts, const std::string& path) {
  for (const Layout& layout : layouts) {
    if (layout.recognises(path)) return &layout;
  }
  return nullptr;
}

/// What was looked for, of all layouts.
template <typename Layout>
std::string looked_for(const std::vector<Layout>& layouts, const std::string& separator) {
  std::string text;
  for (const Layout& layout : layouts) {
    text += (text.empty() ? "" : separator) + std::string(layout.looked_for);
  }
  return text;
}

}  // namespace prospect
