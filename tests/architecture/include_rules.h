#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace prospect::test {

/// What a room's files may include. Libraries are named by the prefix of their headers; the C++
/// standard library and the C library are free to all.
struct RoomRules {
  std::set<std::string> rooms;             ///< the room itself included
  std::set<std::string> libraries;         ///< in any file
  std::set<std::string> header_libraries;  ///< in headers, which others include
};

/// The allowed dependencies (docs/architecture.md).
inline std::map<std::string, RoomRules> architecture() {
  return {
      {"models", {{"models"}, {"Eigen"}, {"Eigen"}}},
      {"engine", {{"models", "engine"}, {"Eigen", "octomap", "fcl"}, {"Eigen"}}},
      {"solvers",
       {{"models", "engine", "solvers"}, {"Eigen", "nlopt", "Ipopt", "ceres"}, {"Eigen"}}},
      {"perception",
       {{"models", "engine", "perception"}, {"Eigen", "octomap", "opencv2", "ceres"}, {"Eigen"}}},
      {"problems", {{"models", "engine", "problems"}, {"Eigen"}, {"Eigen"}}},
      {"adapters",
       {{"models", "engine", "solvers", "problems", "perception", "adapters"},
        {"Eigen", "octomap", "opencv2", "fcl", "yaml-cpp", "nlohmann", "CLI", "hdf5", "mcap",
         "embree3", "assimp"},
        {"Eigen", "nlohmann"}}},
  };
}

/// Parts of a room that may use less of it than the room: prefixes of what they include.
inline std::map<std::string, std::set<std::string>> part_rules() {
  return {
      // Facts only: no maps, no problem, no solver.
      {"engine/behaviour", {"engine/behaviour/", "engine/localization.h", "models/"}},
  };
}

/// The library a header belongs to; empty for the standard library.
inline std::string library_of(const std::string& header) {
  static const std::set<std::string> named = {"Eigen", "octomap",  "fcl",  "opencv2",
                                              "ceres", "yaml-cpp", "CLI",  "nlohmann",
                                              "mcap",  "gtest",    "gmock"};
  const std::string first = header.substr(0, header.find('/'));
  if (header.find('/') != std::string::npos && named.count(first)) return first;
  if (header.rfind("nlopt", 0) == 0) return "nlopt";
  if (header.rfind("hdf5", 0) == 0 || header.rfind("H5", 0) == 0) return "hdf5";
  if (std::regex_match(header, std::regex("(coin/|coin-or/)?(Ip[A-Z].*)"))) return "Ipopt";
  // <vector>, <sys/ioctl.h>, <unistd.h>: no path or the system's own.
  if (header.find('/') == std::string::npos || first == "sys") return "";
  return first;  // a library nobody has allowed
}

/// Every forbidden include below `root`, as "path:line: includes X: why".
inline std::vector<std::string> forbidden_includes(const std::filesystem::path& root) {
  namespace fs = std::filesystem;
  static const std::regex include(R"re(^\s*#\s*include\s*(<|")([^>"]+)[>"].*)re");
  std::vector<std::string> found;
  for (const auto& [room, rules] : architecture()) {
    if (!fs::exists(root / room)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / room)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cc") continue;
      std::ifstream file(entry.path());
      std::string line;
      for (int number = 1; std::getline(file, line); ++number) {
        std::smatch match;
        if (!std::regex_match(line, match, include)) continue;
        const std::string header = match[2];
        const auto report = [&](const std::string& why) {
          found.push_back(fs::relative(entry.path(), root).string() + ":" + std::to_string(number) +
                          ": includes " + header + ": " + why);
        };
        if (match[1] == "\"") {
          const std::string target = header.substr(0, header.find('/'));
          if (!rules.rooms.count(target)) report(room + " may not use " + target);
          const std::string file_path = fs::relative(entry.path(), root).generic_string();
          for (const auto& [part, allowed] : part_rules()) {
            if (file_path.rfind(part + '/', 0) != 0) continue;
            bool may = false;
            for (const std::string& prefix : allowed) may = may || header.rfind(prefix, 0) == 0;
            if (!may) report(part + " may not use " + header);
          }
          continue;
        }
        const std::string library = library_of(header);
        if (library.empty()) continue;
        if (!rules.libraries.count(library)) {
          report(room + " may not use " + library);
        } else if (extension == ".h" && !rules.header_libraries.count(library)) {
          report("headers of " + room + " may not include " + library + "; forward-declare");
        }
      }
    }
  }
  return found;
}

}  // namespace prospect::test
