// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace prospect::test {

/// What a room's files may include. Libraries are named by the prefix of their headers; the C++
/// standard library and the C library are free to all.
struct RoomRules {
  std::set<std::string> may_use;           ///< other rooms, or single files of them
  std::set<std::string> libraries;         ///< in any file
  std::set<std::string> header_libraries;  ///< in headers, which others include
};

/// The allowed dependencies of the rooms of docs/reference/architecture.md: folders of the top
/// level or of engine/. A room may include itself and the rooms named, or a single file of another
/// one. The order is that of the graph: a room uses only what stands above it, so there is no loop.
inline std::vector<std::pair<std::string, RoomRules>> architecture() {
  const std::set<std::string> eigen = {"Eigen"};
  const std::set<std::string> json = {"Eigen", "nlohmann"};
  const std::set<std::string> geometry = {"Eigen", "octomap", "fcl"};
  return {
      {"models", {{}, eigen, eigen}},
      {"engine/support", {{"models"}, eigen, eigen}},
      // Facts only: no maps, no problem, no solver.
      {"engine/behaviour", {{"models", "engine/maps/localization.h"}, eigen, eigen}},
      {"engine/task", {{"models", "engine/behaviour/task_kind.h"}, eigen, eigen}},
      {"engine/maps", {{"models", "engine/task", "engine/support/resumable.h"}, geometry, eigen}},
      {"engine/problem", {{"models", "engine/task"}, eigen, eigen}},
      {"engine/features",
       {{"models", "engine/support", "engine/maps", "engine/problem"}, geometry, eigen}},
      {"engine/frontiers",
       {{"models", "engine/support", "engine/task", "engine/maps", "engine/features",
         "engine/behaviour"},
        geometry,
        eigen}},
      // Of the frontiers, terms see what they weigh: targets and the cost-to-go.
      {"engine/terms",
       {{"models", "engine/task", "engine/maps", "engine/problem", "engine/features",
         "engine/frontiers/cost_to_go.h", "engine/frontiers/exploration_targets.h"},
        eigen,
        eigen}},
      {"engine/safety",
       {{"models", "engine/behaviour", "engine/task", "engine/maps", "engine/problem"},
        geometry,
        eigen}},
      {"engine/planner", {{"models", "engine"}, geometry, eigen}},
      // The specification only for the size of what a plug-in's terms are made of.
      {"solvers",
       {{"models", "engine/support", "engine/problem", "engine/terms/problem_specification.h"},
        {"Eigen", "nlopt", "Ipopt", "ceres"},
        eigen}},
      {"problems", {{"models", "engine/support", "engine/problem"}, eigen, eigen}},
      {"perception/odometry",
       {{"models", "engine/support", "engine/maps", "engine/features"},
        {"Eigen", "opencv2", "ceres"},
        eigen}},
      {"perception/fusion",
       {{"models", "engine/support", "engine/maps", "perception/odometry"}, {"Eigen"}, eigen}},
      {"perception/mapping",
       {{"models", "engine/support", "engine/maps", "perception/odometry"},
        {"Eigen", "octomap", "opencv2"},
        eigen}},
      {"perception/graph",
       {{"models", "engine/support", "perception/odometry", "perception/mapping/pose_check.h"},
        {"Eigen", "ceres"},
        eigen}},
      {"perception/places",
       {{"models", "engine/maps", "perception/odometry", "perception/mapping", "perception/graph"},
        {"Eigen", "opencv2"},
        eigen}},
      {"perception/pipeline",
       {{"models", "engine/support", "engine/maps", "engine/features", "perception"},
        {"Eigen", "octomap"},
        eigen}},
      {"runtime", {{"models", "engine", "perception"}, eigen, eigen}},
      {"adapters/formats/files", {{"models"}, {"Eigen", "yaml-cpp"}, eigen}},
      {"adapters/formats/images",
       {{"models", "adapters/formats/files"}, {"Eigen", "opencv2"}, eigen}},
      {"adapters/formats/ros", {{"models", "adapters/formats/files"}, {"Eigen"}, eigen}},
      {"adapters/formats/bags", {{"models", "adapters/formats/files"}, {"mcap"}, eigen}},
      {"adapters/formats/worlds",
       {{"models", "engine", "perception", "adapters/formats/files", "adapters/formats/images"},
        {"Eigen", "octomap", "opencv2", "assimp", "nlohmann"},
        eigen}},
      {"adapters/formats/problem_file", {{"models", "engine"}, {"Eigen", "hdf5"}, eigen}},
      {"adapters/formats/programmes",
       {{"models", "engine", "problems", "adapters/formats/files"}, {"Eigen"}, eigen}},
      {"adapters/formats/datasets",
       {{"models", "engine", "perception", "adapters/formats/files", "adapters/formats/images",
         "adapters/formats/ros", "adapters/formats/bags"},
        {"Eigen", "octomap", "opencv2"},
        eigen}},
      {"adapters/views/page",
       {{"models", "perception", "adapters/formats/files", "adapters/formats/images"},
        {"Eigen", "opencv2", "nlohmann"},
        json}},
      {"adapters/robots/faults",
       {{"models", "engine", "perception", "runtime", "adapters/formats/files"}, {"Eigen"}, eigen}},
      {"adapters/robots/simulator",
       {{"models", "engine", "perception", "runtime", "adapters/formats/files",
         "adapters/formats/worlds", "adapters/robots/faults"},
        {"Eigen", "octomap", "opencv2", "embree3"},
        eigen}},
      {"adapters/robots/gazebo",
       {{"models", "engine", "perception", "runtime", "adapters/formats/files",
         "adapters/formats/images", "adapters/formats/worlds", "adapters/robots/faults",
         "adapters/robots/simulator"},
        {"Eigen", "opencv2"},
        eigen}},
      {"adapters/robots/dds",
       {{"models", "engine", "perception", "runtime", "adapters/formats/files",
         "adapters/formats/images", "adapters/formats/ros", "adapters/formats/datasets",
         "adapters/robots/faults"},
        {"Eigen", "octomap", "dds", "openssl"},
        eigen}},
      {"adapters/robots/user",
       {{"models", "engine", "perception", "runtime", "adapters/robots/faults"}, {"Eigen"}, eigen}},
      // Of worlds, robots and perception, a configuration sees the options.
      {"adapters/missions/config",
       {{"models", "engine", "solvers", "perception/pipeline/perception_options.h", "runtime",
         "adapters/formats/files", "adapters/formats/worlds/world_options.h",
         "adapters/robots/simulator/simulator_options.h",
         "adapters/robots/simulator/simulated_base_options.h",
         "adapters/robots/gazebo/gazebo_options.h"},
        {"Eigen"},
        eigen}},
      {"adapters/missions/recordings",
       {{"models", "engine", "perception", "adapters/formats/files", "adapters/formats/images",
         "adapters/formats/bags", "adapters/formats/datasets", "adapters/views/page"},
        {"Eigen", "octomap", "opencv2", "nlohmann"},
        json}},
      {"adapters/missions/run",
       {{"models", "engine", "solvers", "perception", "runtime", "adapters/formats/files",
         "adapters/formats/images", "adapters/formats/problem_file", "adapters/views/page",
         "adapters/formats/worlds", "adapters/robots/faults", "adapters/robots/simulator",
         "adapters/robots/gazebo", "adapters/robots/dds", "adapters/robots/user",
         "adapters/missions/config"},
        {"Eigen", "octomap", "nlohmann"},
        json}},
      {"adapters/views/report",
       {{"models", "engine", "solvers", "perception", "adapters/formats/files",
         "adapters/formats/images", "adapters/formats/worlds", "adapters/views/page",
         "adapters/missions/config", "adapters/missions/run"},
        {"Eigen", "octomap", "opencv2", "nlohmann"},
        json}},
      {"adapters/missions/log",
       {{"models", "engine", "perception", "runtime", "adapters/formats/files",
         "adapters/formats/ros", "adapters/formats/bags", "adapters/formats/datasets",
         "adapters/views/page", "adapters/missions/config", "adapters/missions/run"},
        {"Eigen", "octomap"},
        eigen}},
      {"adapters/views/live",
       {{"models", "engine", "perception", "runtime", "adapters/formats/files",
         "adapters/formats/images", "adapters/formats/ros", "adapters/views/page",
         "adapters/missions/config", "adapters/missions/run", "adapters/views/report",
         "adapters/missions/log"},
        {"Eigen", "nlohmann", "boost"},
        eigen}},
      {"adapters/missions/bench",
       {{"models", "engine", "solvers", "problems", "adapters/formats/files",
         "adapters/formats/worlds", "adapters/formats/problem_file", "adapters/formats/programmes",
         "adapters/views/page", "adapters/missions/config", "adapters/missions/run",
         "adapters/views/report"},
        {"Eigen", "nlohmann"},
        json}},
      {"adapters/missions/study",
       {{"models", "engine", "solvers", "perception", "runtime", "adapters/formats/files",
         "adapters/formats/worlds", "adapters/views/page", "adapters/missions/config",
         "adapters/missions/run", "adapters/missions/recordings", "adapters/views/report",
         "adapters/missions/bench"},
        {"Eigen", "nlohmann", "hdf5"},
        json}},
      {"adapters/missions/replay",
       {{"models", "engine", "solvers", "perception", "runtime", "adapters/formats/files",
         "adapters/formats/ros", "adapters/formats/bags", "adapters/formats/worlds",
         "adapters/formats/datasets", "adapters/views/page", "adapters/missions/config",
         "adapters/missions/run", "adapters/views/report", "adapters/missions/log"},
        {"Eigen", "nlohmann"},
        json}},
      {"adapters/program/cli",
       {{"models", "engine", "solvers", "problems", "perception", "runtime", "adapters"},
        {"Eigen", "octomap", "nlohmann", "CLI"},
        {"Eigen", "nlohmann", "CLI"}}},
      {"adapters/program/robot",
       {{"models", "engine", "solvers", "runtime", "adapters"}, {"Eigen", "CLI"}, eigen}},
      {"adapters/program/external",
       {{"models", "engine", "adapters/formats/problem_file"}, {"Eigen"}, {}}},
      {"adapters/program/python",
       {{"models", "engine", "solvers", "problems", "perception", "runtime", "adapters"},
        {"Eigen", "octomap", "pybind11"},
        {"Eigen", "pybind11"}}},
  };
}

/// The room that a path lies in, "" if it is none: the deepest.
inline std::string room_of(const std::string& path) {
  std::string found;
  for (const auto& [room, rules] : architecture()) {
    if (path.rfind(room + '/', 0) == 0 && room.size() > found.size()) found = room;
  }
  return found;
}

/// Whether `path` is the file `allowed` or lies below that folder.
inline bool is_part_of(const std::string& path, const std::string& allowed) {
  return path == allowed || path.rfind(allowed + '/', 0) == 0;
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
  // <vector>, <sys/ioctl.h>, <ext/stdio_filebuf.h>: no path, the system's or the compiler's own.
  if (header.find('/') == std::string::npos || first == "sys" || first == "ext" ||
      first == "netinet" || first == "arpa") {
    return "";
  }
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
      const std::string file_path = fs::relative(entry.path(), root).generic_string();
      std::ifstream file(entry.path());
      std::string line;
      for (int number = 1; std::getline(file, line); ++number) {
        std::smatch match;
        if (!std::regex_match(line, match, include)) continue;
        const std::string header = match[2];
        const auto report = [&](const std::string& why) {
          found.push_back(file_path + ":" + std::to_string(number) + ": includes " + header + ": " +
                          why);
        };
        if (match[1] == "\"") {
          bool may = is_part_of(header, room);
          for (const std::string& other : rules.may_use) may = may || is_part_of(header, other);
          if (!may) report(room + " may not use " + header);
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

/// Sources and headers of models/, engine/ and below that lie in no room.
inline std::vector<std::string> outside_rooms(const std::filesystem::path& root) {
  namespace fs = std::filesystem;
  std::vector<std::string> found;
  for (const char* top :
       {"models", "engine", "solvers", "problems", "perception", "runtime", "adapters"}) {
    if (!fs::exists(root / top)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cc") continue;
      const std::string path = fs::relative(entry.path(), root).generic_string();
      if (room_of(path).empty()) found.push_back(path);
    }
  }
  return found;
}

/// A loop among the headers below `root` ("a.h b.h a.h"), "" if there is none.
inline std::string include_loop(const std::filesystem::path& root) {
  namespace fs = std::filesystem;
  static const std::regex include(R"re(^\s*#\s*include\s*"([^"]+)".*)re");
  std::map<std::string, std::vector<std::string>> uses;
  for (const auto& [room, rules] : architecture()) {
    if (!fs::exists(root / room)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / room)) {
      if (entry.path().extension() != ".h") continue;
      std::ifstream file(entry.path());
      std::string line;
      std::vector<std::string>& own = uses[fs::relative(entry.path(), root).generic_string()];
      own.clear();
      for (std::smatch match; std::getline(file, line);) {
        if (std::regex_match(line, match, include)) own.push_back(match[1]);
      }
    }
  }
  std::set<std::string> done;
  std::vector<std::string> way;
  std::string loop;
  const auto visit = [&](const auto& self, const std::string& header) -> void {
    if (!loop.empty() || done.count(header)) return;
    const bool met = std::find(way.begin(), way.end(), header) != way.end();
    way.push_back(header);
    if (met) {
      for (auto it = std::find(way.begin(), way.end(), header); it != way.end(); ++it) {
        loop += (loop.empty() ? "" : " ") + *it;
      }
      return;
    }
    for (const std::string& other : uses[header]) self(self, other);
    way.pop_back();
    done.insert(header);
  };
  std::vector<std::string> headers;
  for (const auto& [header, others] : uses) headers.push_back(header);
  for (const std::string& header : headers) visit(visit, header);
  return loop;
}

/// The first room whose rules name a room below it in the table, "" if there is none; single files
/// aside.
inline std::string upward_rule() {
  std::set<std::string> above;
  for (const auto& [room, rules] : architecture()) {
    for (const std::string& other : rules.may_use) {
      const bool single = other.size() > 2 && other.substr(other.size() - 2) == ".h";
      bool known = single;
      for (const std::string& earlier : above) known = known || is_part_of(earlier, other);
      if (!known) return room + " may use " + other;
    }
    above.insert(room);
  }
  return "";
}

}  // namespace prospect::test
