// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/g2o_file.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <set>
#include <sstream>
#include <utility>

#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "models/types.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::size_t kMostProblems = 20;

/// The words of one line after the first one.
struct G2oLine {
  std::string where;
  std::vector<std::string> words;

  int id(std::size_t k) const {
    int value = -1;
    if (!parse_number(words[k], value) || value < 0) {
      fail(where, "'" + words[k] + "' as a vertex; expected a number from 0 on");
    }
    return value;
  }
  double number(std::size_t k) const {
    double value = 0.0;
    if (!parse_number(words[k], value) || !std::isfinite(value)) {
      fail(where, "'" + words[k] + "'; expected a finite number");
    }
    return value;
  }
  void expect(std::size_t count, const std::string& what) const {
    if (words.size() != count) {
      fail(where, std::to_string(words.size()) + " numbers; expected " + std::to_string(count) +
                      ": " + what);
    }
  }
  Isometry3d near(const Isometry3d& T) const {
    if (T.translation().cwiseAbs().maxCoeff() > kFarthest) {
      fail(where, "farther than 1e6 m from the origin; expected metres");
    }
    return T;
  }
  Isometry3d planar_pose(std::size_t k) const {
    Isometry3d T = Isometry3d::Identity();
    T.translation() << number(k), number(k + 1), 0.0;
    T.linear() = Eigen::AngleAxisd(number(k + 2), Vector3d::UnitZ()).toRotationMatrix();
    return near(T);
  }
  Isometry3d pose(std::size_t k) const {
    const Vector3d position(number(k), number(k + 1), number(k + 2));
    const Eigen::Quaterniond q(number(k + 6), number(k + 3), number(k + 4), number(k + 5));
    return near(checked_pose(position, q, where));
  }
  /// The rows of an upper triangle, entries for those of t and omega that `of` names.
  Eigen::Matrix<double, 6, 6> information(std::size_t k, const std::vector<int>& of) const {
    Eigen::Matrix<double, 6, 6> result = Eigen::Matrix<double, 6, 6>::Zero();
    for (std::size_t r = 0; r < of.size(); ++r) {
      for (std::size_t c = r; c < of.size(); ++c) {
        result(of[r], of[c]) = result(of[c], of[r]) = number(k++);
      }
    }
    return result;
  }
};

void read_line(const std::string& kind, const G2oLine& line, G2oGraph& graph,
               std::vector<std::pair<std::string, int>>& fixed) {
  const auto vertex = [&](const Isometry3d& T) {
    if (!graph.vertices.emplace(line.id(0), T).second) {
      fail(line.where, "vertex " + line.words[0] + " a second time; expected each once");
    }
  };
  const auto edge = [&](const Isometry3d& T, Eigen::Matrix<double, 6, 6> information) {
    const int from = line.id(0), to = line.id(1);
    if (from == to) {
      fail(line.where, "an edge from vertex " + line.words[0] + " to itself; expected two");
    }
    if (!is_information(information)) {
      fail(line.where,
           "not an information matrix; expected one that is positive definite, with standard "
           "deviations between 1e-6 and 1e6");
    }
    graph.edges.push_back({from, to, {T, std::move(information)}, line.where});
  };
  if (kind == "VERTEX_SE2") {
    line.expect(4, "id x y yaw");
    vertex(line.planar_pose(1));
  } else if (kind == "VERTEX_SE3:QUAT") {
    line.expect(8, "id x y z qx qy qz qw");
    vertex(line.pose(1));
  } else if (kind == "EDGE_SE2") {
    line.expect(11, "from to x y yaw, and 6 of the information");
    Eigen::Matrix<double, 6, 6> information = line.information(5, {0, 1, 5});
    information(2, 2) = 0.5 * (information(0, 0) + information(1, 1));
    information(3, 3) = information(4, 4) = information(5, 5);
    edge(line.planar_pose(2), information);
  } else if (kind == "EDGE_SE3:QUAT") {
    line.expect(30, "from to x y z qx qy qz qw, and 21 of the information");
    edge(line.pose(2), line.information(9, {0, 1, 2, 3, 4, 5}));
  } else if (kind == "FIX") {
    for (std::size_t k = 0; k < line.words.size(); ++k) fixed.emplace_back(line.where, line.id(k));
  } else if (kind != "PARAMS_SE3OFFSET") {
    fail(line.where, "'" + kind +
                         "'; expected VERTEX_SE2, VERTEX_SE3:QUAT, EDGE_SE2, "
                         "EDGE_SE3:QUAT or FIX");
  }
}

void add_unknown_vertices(const G2oGraph& graph,
                          const std::vector<std::pair<std::string, int>>& fixed,
                          std::vector<std::string>& problems) {
  std::set<int> known;
  for (const auto& [id, T] : graph.vertices) known.insert(id);
  const bool named_by_edges = known.empty();
  const auto check = [&](const std::string& where, int id) {
    if (named_by_edges) {
      known.insert(id);
    } else if (!known.contains(id)) {
      problems.push_back(where + ": vertex " + std::to_string(id) +
                         " is not in the file; expected a line VERTEX_... of it");
    }
  };
  for (const G2oGraph::Edge& edge : graph.edges) {
    check(edge.where, edge.from);
    check(edge.where, edge.to);
  }
  for (const auto& [where, id] : fixed) {
    if (!known.contains(id)) {
      problems.push_back(where + ": vertex " + std::to_string(id) +
                         " is not in the file; expected one that is");
    }
  }
}

/// Sets that are joined until all is one (Kruskal 1956).
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  /// Whether they were apart.
  bool join(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parent_[a] = b;
    return a != b;
  }

 private:
  std::vector<std::size_t> parent_;
};

std::vector<int> ids_of(const G2oGraph& graph) {
  std::set<int> ids;
  for (const auto& [id, T] : graph.vertices) ids.insert(id);
  for (const G2oGraph::Edge& edge : graph.edges) ids.insert({edge.from, edge.to});
  return {ids.begin(), ids.end()};
}

}  // namespace

G2oGraph read_g2o(const std::string& path) {
  G2oGraph graph;
  graph.path = path;
  std::istringstream text(read_whole_file(path));
  std::vector<std::string> problems;
  std::vector<std::pair<std::string, int>> fixed;
  std::string content, kind;
  for (int n = 1; std::getline(text, content) && problems.size() < kMostProblems; ++n) {
    std::istringstream words(content.substr(0, content.find('#')));
    if (!(words >> kind)) continue;
    G2oLine line;
    line.where = path + ":" + std::to_string(n);
    for (std::string word; words >> word;) line.words.push_back(word);
    try {
      read_line(kind, line, graph, fixed);
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.lines().begin(), error.lines().end());
    }
  }
  if (problems.empty()) add_unknown_vertices(graph, fixed, problems);
  if (problems.empty() && graph.vertices.empty() && graph.edges.empty()) {
    problems.push_back(path + ": neither vertices nor edges; expected a pose graph of g2o");
  }
  if (problems.size() > kMostProblems) problems.resize(kMostProblems);
  if (!problems.empty()) throw InputError(problems);
  return graph;
}

G2oOrder order_of(const G2oGraph& graph) {
  const std::vector<int> ids = ids_of(graph);
  if (ids.empty()) fail(graph.path, "no vertex; expected a pose graph");
  std::map<int, std::size_t> rank;
  for (std::size_t k = 0; k < ids.size(); ++k) rank[ids[k]] = k;
  const auto apart = [&](std::size_t e) {
    const std::size_t a = rank[graph.edges[e].from], b = rank[graph.edges[e].to];
    return a > b ? a - b : b - a;
  };
  std::vector<std::size_t> nearest(graph.edges.size());
  std::iota(nearest.begin(), nearest.end(), std::size_t{0});
  std::stable_sort(nearest.begin(), nearest.end(),
                   [&](std::size_t e, std::size_t f) { return apart(e) < apart(f); });
  JoinedSets sets(ids.size());
  std::vector<char> in_tree(graph.edges.size(), 0);
  std::vector<std::vector<std::size_t>> edges_at(ids.size());
  for (const std::size_t e : nearest) {
    const std::size_t a = rank[graph.edges[e].from], b = rank[graph.edges[e].to];
    if (!sets.join(a, b)) continue;
    in_tree[e] = 1;
    edges_at[a].push_back(e);
    edges_at[b].push_back(e);
  }
  for (const int id : ids) {
    if (sets.find(rank[id]) == sets.find(0)) continue;
    fail(graph.path, "no way along edges from vertex " + std::to_string(ids[0]) + " to vertex " +
                         std::to_string(id) + "; expected a graph in one piece");
  }
  G2oOrder order;
  order.first = ids[0];
  std::vector<std::size_t> reached = {0};
  std::vector<char> seen(ids.size(), 0);
  seen[0] = 1;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const int from = ids[reached[k]];
    for (const std::size_t e : edges_at[reached[k]]) {
      const G2oGraph::Edge& edge = graph.edges[e];
      const bool forward = edge.from == from;
      const std::size_t next = rank[forward ? edge.to : edge.from];
      if (seen[next]) continue;
      seen[next] = 1;
      reached.push_back(next);
      order.odometry.push_back({ids[next], from, forward ? edge.measured : inverse(edge.measured)});
    }
  }
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    if (!in_tree[e]) order.loops.push_back(e);
  }
  return order;
}

std::map<int, Isometry3d> poses_of(const G2oGraph& graph) {
  if (!graph.vertices.empty()) return graph.vertices;
  const G2oOrder order = order_of(graph);
  std::map<int, Isometry3d> poses = {{order.first, Isometry3d::Identity()}};
  for (const G2oOrder::Step& step : order.odometry) {
    poses[step.id] = poses[step.from] * step.measured.T;
  }
  return poses;
}

}  // namespace prospect
