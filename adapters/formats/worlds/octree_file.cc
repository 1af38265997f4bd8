// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/octree_file.h"

#include <fcntl.h>
#include <octomap/OcTree.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/formats/files/whole_file.h"

namespace prospect {
namespace {

constexpr int kTreeDepth = 16;  // the library's fixed depth

/// The library creates a root only by way of a voxel; a reader starts with the root alone.
class RootedOcTree : public octomap::OcTree {
 public:
  using octomap::OcTree::OcTree;
  octomap::OcTreeNode* make_root() {
    root = new octomap::OcTreeNode();
    tree_size = 1;
    size_changed = true;
    return root;
  }
};

struct Header {
  bool binary = false;  ///< .bt
  std::size_t nodes = 0;
  double resolution = 0.0;
  std::size_t data = 0;    ///< offset of the first node's bytes
  std::size_t colour = 0;  ///< bytes of a node's colour in an .ot
  /// Of a node of an .ot: log-odds, colour, which children there are.
  std::size_t node_bytes() const { return 4 + colour + 1; }
};

std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, 40)) out += c >= 0x20 && c < 0x7f ? c : '?';
  return text.size() > 40 ? out + "..." : out;
}

Header parse_header(std::string_view bytes, const std::string& source, const OctreeLimits& limits) {
  constexpr std::string_view kBinary = "# Octomap OcTree binary file";
  constexpr std::string_view kFull = "# Octomap OcTree file";
  constexpr std::size_t kLongestHeader = 65536;  // comments included
  Header header;
  header.binary = bytes.starts_with(kBinary);
  if (!header.binary && !bytes.starts_with(kFull)) {
    fail(source, "not an OctoMap file; expected the first line '" + std::string(kBinary) +
                     "' (.bt) or '" + std::string(kFull) + "' (.ot)");
  }
  std::string_view id, size, resolution;
  std::size_t at = 0;
  int line = 0;
  bool data = false;
  while (!data) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string_view::npos || end > kLongestHeader) {
      fail(source, "the header does not end; expected the lines id, size, res, data");
    }
    std::string_view text = bytes.substr(at, end - at);
    at = end + 1;
    ++line;
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    if (text.empty() || text.front() == '#') continue;
    const std::size_t space = text.find(' ');
    const std::string_view key = text.substr(0, space);
    std::string_view value =
        space == std::string_view::npos ? std::string_view{} : text.substr(space + 1);
    while (!value.empty() && value.back() == ' ') value.remove_suffix(1);
    std::string_view* slot = key == "id"     ? &id
                             : key == "size" ? &size
                             : key == "res"  ? &resolution
                                             : nullptr;
    if (key == "data") {
      data = true;
    } else if (slot == nullptr || !slot->empty()) {
      fail(source + ":" + std::to_string(line),
           (slot == nullptr ? "unknown header line '" : "repeated header line '") +
               printable(text) + "'; expected id, size, res, data");
    } else {
      *slot = value;
    }
  }
  header.data = at;
  if (id == "ColorOcTree") {
    header.colour = 3;
  } else if (id != "OcTree" && id != "OcTreeStamped") {
    fail(source,
         "tree type '" + printable(id) + "'; expected OcTree, OcTreeStamped or ColorOcTree");
  }
  if (!parse_number(size, header.nodes)) {
    fail(source, "size '" + printable(size) + "'; expected the number of nodes");
  }
  if (header.nodes > limits.max_nodes) {
    fail(source, std::to_string(header.nodes) + " nodes; expected at most " +
                     std::to_string(limits.max_nodes));
  }
  if (!parse_number(resolution, header.resolution) ||
      !(header.resolution >= limits.min_resolution) ||
      !(header.resolution <= limits.max_resolution)) {
    std::ostringstream range;
    range << limits.min_resolution << " to " << limits.max_resolution;
    fail(source, "resolution '" + printable(resolution) + "'; expected " + range.str() + " m");
  }
  return header;
}

/// A node whose children are still being read.
struct Open {
  octomap::OcTreeNode* node;
  std::uint32_t children;  ///< two bits a child in a .bt, one in an .ot
  int next;                ///< index of the next child
};

class NodeReader {
 public:
  NodeReader(std::string_view bytes, const Header& header, const std::string& source)
      : bytes_(bytes), at_(header.data), header_(header), source_(source) {}

  std::unique_ptr<octomap::OcTree> read() {
    auto tree = std::make_unique<RootedOcTree>(header_.resolution);
    if (header_.nodes > 0) {
      if (header_.binary) {
        read_binary(*tree);
      } else {
        read_full(*tree);
      }
      if (tree->size() != header_.nodes) {
        fail(source_, "corrupt: " + std::to_string(tree->size()) + " nodes; expected " +
                          std::to_string(header_.nodes) + " as the header says");
      }
    }
    if (at_ != bytes_.size()) {
      fail(source_, "corrupt: " + std::to_string(bytes_.size() - at_) +
                        " bytes follow the last node; expected the end of the file");
    }
    return tree;
  }

 private:
  std::uint32_t byte() {
    if (at_ >= bytes_.size()) {
      fail(source_, "ends at byte " + std::to_string(bytes_.size()) +
                        " within the tree; expected " + std::to_string(header_.nodes) +
                        " nodes (truncated or corrupt)");
    }
    return static_cast<unsigned char>(bytes_[at_++]);
  }

  octomap::OcTreeNode* add_child(RootedOcTree& tree, octomap::OcTreeNode* parent, int child) {
    if (tree.size() >= header_.nodes) {
      fail(source_, "corrupt: more nodes than the " + std::to_string(header_.nodes) +
                        " of the header; expected as many");
    }
    return tree.createNodeChild(parent, static_cast<unsigned>(child));
  }

  [[noreturn]] void too_deep() {
    fail(source_, "corrupt: nodes below level 16 at byte " + std::to_string(at_) +
                      "; expected leaves there");
  }

  void read_binary(RootedOcTree& tree) {
    const float occupied = tree.getClampingThresMaxLog();
    const float free = tree.getClampingThresMinLog();
    const auto open = [&](octomap::OcTreeNode* node) {
      std::uint32_t children = byte();
      children |= byte() << 8;
      if (children == 0) {
        fail(source_, "corrupt: an inner node without children at byte " + std::to_string(at_ - 2) +
                          "; expected at least one");
      }
      return Open{node, children, 0};
    };
    std::vector<Open> stack;
    stack.reserve(kTreeDepth + 1);
    // The library writes all children of a node before it descends into the first.
    const auto create_children = [&](Open& parent) {
      for (int child = 0; child < 8; ++child) {
        const std::uint32_t kind = (parent.children >> (2 * child)) & 3u;
        if (kind == 0) continue;
        add_child(tree, parent.node, child)->setLogOdds(kind == 1 ? free : occupied);
      }
    };
    stack.push_back(open(tree.make_root()));
    create_children(stack.back());
    while (!stack.empty()) {
      Open& top = stack.back();
      while (top.next < 8 && ((top.children >> (2 * top.next)) & 3u) != 3u) ++top.next;
      if (top.next == 8) {
        top.node->setLogOdds(top.node->getMaxChildLogOdds());
        stack.pop_back();
        continue;
      }
      if (stack.size() >= kTreeDepth) too_deep();
      octomap::OcTreeNode* child = tree.getNodeChild(top.node, static_cast<unsigned>(top.next++));
      stack.push_back(open(child));
      create_children(stack.back());
    }
  }

  void read_full(RootedOcTree& tree) {
    const auto open = [&](octomap::OcTreeNode* node, std::size_t level) {
      const std::size_t start = at_;
      std::uint32_t bits = 0;
      for (int i = 0; i < 4; ++i)
        bits |= byte() << (8 * i);  // little endian, as the library writes
      float value;
      static_assert(sizeof(value) == sizeof(bits));
      std::memcpy(&value, &bits, sizeof(value));
      if (!std::isfinite(value)) {
        fail(source_, "corrupt: log-odds not finite at byte " + std::to_string(start) +
                          "; expected a finite number");
      }
      node->setLogOdds(value);
      for (std::size_t n = 0; n < header_.colour; ++n) byte();
      const std::uint32_t children = byte();
      if (level >= kTreeDepth && children != 0) too_deep();
      return Open{node, children, 0};
    };
    std::vector<Open> stack;
    stack.reserve(kTreeDepth + 1);
    stack.push_back(open(tree.make_root(), 0));
    while (!stack.empty()) {
      Open& top = stack.back();
      while (top.next < 8 && ((top.children >> top.next) & 1u) == 0) ++top.next;
      if (top.next == 8) {
        stack.pop_back();
        continue;
      }
      octomap::OcTreeNode* child = add_child(tree, top.node, top.next++);
      stack.push_back(open(child, stack.size()));
    }
  }

  std::string_view bytes_;
  std::size_t at_;
  const Header& header_;
  const std::string& source_;
};

}  // namespace

std::unique_ptr<octomap::OcTree> parse_octree(std::string_view bytes, const std::string& source,
                                              const OctreeLimits& limits, LeftOut* left_out) {
  if (bytes.empty()) fail(source, "empty file; expected an OctoMap .bt or .ot file");
  const Header header = parse_header(bytes, source, limits);
  const std::size_t left = bytes.size() - header.data;
  // Known from the header alone, before any memory is spent: an inner node of a .bt takes two bytes
  // and has at most eight children; a node of an .ot takes five bytes, or eight with its colour.
  const bool fits =
      header.binary ? header.nodes <= 4 * left + 1 : header.nodes == left / header.node_bytes();
  if (!fits) {
    fail(source,
         std::to_string(left) + " bytes of data; expected " +
             (header.binary ? "enough for "
                            : std::to_string(header.node_bytes() * header.nodes) + " for ") +
             std::to_string(header.nodes) + " nodes (truncated or corrupt)");
  }
  if (left_out != nullptr && header.colour > 0 && !header.binary) {
    left_out->name("colours of voxels");
  }
  return NodeReader(bytes, header, source).read();
}

std::unique_ptr<octomap::OcTree> read_octree(const std::string& path, const OctreeLimits& limits,
                                             LeftOut* left_out) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    fail(path, "no such file; expected an OctoMap .bt or .ot file");
  }
  if (!std::filesystem::is_regular_file(status)) {
    fail(path, std::string(std::filesystem::is_directory(status) ? "is a directory"
                                                                 : "is not a regular file") +
                   "; expected an OctoMap .bt or .ot file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) fail(path, "cannot be read (" + error.message() + "); expected a readable file");
  if (size > limits.max_bytes) {
    fail(path,
         std::to_string(size) + " bytes; expected at most " + std::to_string(limits.max_bytes));
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in || static_cast<std::uintmax_t>(in.gcount()) != size) {
    fail(path, "cannot be read; expected a readable file");
  }
  return parse_octree(bytes, path, limits, left_out);
}

void write_octree(const octomap::OcTree& tree, const std::string& path) {
  // Header and nodes by hand: the library's writer reports on standard error.
  std::array<char, 32> resolution;
  const auto end =
      std::to_chars(resolution.data(), resolution.data() + resolution.size(), tree.getResolution());
  std::ostringstream out(std::ios::binary);
  out << "# Octomap OcTree binary file\n"
      << "id " << tree.getTreeType() << "\nsize " << tree.size() << "\nres "
      << std::string_view(resolution.data(), static_cast<std::size_t>(end.ptr - resolution.data()))
      << "\ndata\n";
  if (tree.getRoot() != nullptr) tree.writeBinaryNode(out, tree.getRoot());
  const std::string bytes = std::move(out).str();
  const std::string temporary = path + kPart;
  const int file =
      ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (file < 0) {
    fail(path, std::string("cannot be written (") + std::strerror(errno) +
                   "); expected a writable folder");
  }
  int error = 0;
  for (std::size_t at = 0; at < bytes.size() && error == 0;) {
    const ssize_t n = ::write(file, bytes.data() + at, bytes.size() - at);
    if (n >= 0) {
      at += static_cast<std::size_t>(n);
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  if (error == 0 && ::fsync(file) != 0) error = errno;
  if (::close(file) != 0 && error == 0) error = errno;
  if (error == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    fail(path, std::string("cannot be written (") + std::strerror(error) +
                   "); expected a writable folder with space");
  }
}

}  // namespace prospect
