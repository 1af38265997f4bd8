// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/adapter_table.h"

#include <dlfcn.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <vector>

#include "adapters/formats/files/child_process.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

/// The folder of the library that holds this code; empty: the program does.
fs::path own_library_folder() {
  Dl_info here{};
  if (dladdr(adapters().data(), &here) == 0 || here.dli_fname == nullptr) return {};
  const fs::path file = here.dli_fname;
  return file.extension() == ".so" ? fs::absolute(file).parent_path() : fs::path();
}

/// Whether the folder holds a library NAME.so or, made for one interpreter, NAME.VERSION.so.
bool holds_module(const fs::path& folder, const std::string& name) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string file = entry.path().filename();
    if (file.starts_with(name + '.') && file.ends_with(".so")) return true;
  }
  return false;
}

}  // namespace

std::string lacks(const Adapter& adapter) {
  if (!adapter.missing.empty() || adapter.modules.empty()) return std::string(adapter.missing);
  std::vector<fs::path> folders = {own_library_folder()};
  if (folders.front().empty()) {
    const fs::path program = fs::path(own_program()).parent_path();
    const fs::path library = program.parent_path() / python_library();
    folders = {program / "python", library / "dist-packages", library / "site-packages"};
    for (fs::path& folder : folders) folder /= "prospect";
  }
  const bool there = std::ranges::any_of(folders, [&](const fs::path& folder) {
    std::istringstream names{std::string(adapter.modules)};
    for (std::string name; names >> name;) {
      if (!holds_module(folder, name)) return false;
    }
    return true;
  });
  return there ? "" : "cmake --build build --target product, with PROSPECT_PYTHON=ON";
}

}  // namespace prospect
