// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "adapters/formats/worlds/left_out.h"

namespace octomap {
class OcTree;
}

namespace prospect {

/// Bounds that a reader of untrusted octree files keeps.
struct OctreeLimits {
  std::size_t max_bytes = std::size_t{512} << 20;  ///< of the file
  std::size_t max_nodes = 40'000'000;              ///< about 2.5 GB in memory
  double min_resolution = 1e-3;                    ///< [m]
  double max_resolution = 10.0;                    ///< [m]
};

/// Reads an OctoMap file, .bt (three states) or .ot (log-odds), told apart by its first line, of
/// the types OcTree, OcTreeStamped (whose times are in no file) and ColorOcTree (whose colours are
/// read past, and told in `left_out`). The library's own readers recurse without bound and accept
/// corrupt data, so this one walks the nodes with an explicit stack, at most 16 levels deep, within
/// the bytes there are, and accepts a file only if the number of nodes is the header's, every
/// log-odds value is finite, no inner node is without children and nothing follows the last node.
/// The leaves are those of the library's reader on a valid file; inner nodes of a .bt hold the
/// maximum of their children.
///
/// Throws InputError, one line: missing file, directory, empty, too large, not an OctoMap file,
/// other tree type, truncated, corrupt.
std::unique_ptr<octomap::OcTree> read_octree(const std::string& path,
                                             const OctreeLimits& limits = {},
                                             LeftOut* left_out = nullptr);
/// The same from bytes; `source` stands for the file's name in messages.
std::unique_ptr<octomap::OcTree> parse_octree(std::string_view bytes, const std::string& source,
                                              const OctreeLimits& limits = {},
                                              LeftOut* left_out = nullptr);

/// Writes the tree as .bt: to a temporary file beside `path`, synced, then renamed, so that `path`
/// never holds half a map. The tree is not changed (not pruned). Throws InputError if it cannot.
void write_octree(const octomap::OcTree& tree, const std::string& path);

}  // namespace prospect
