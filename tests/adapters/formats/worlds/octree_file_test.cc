// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/octree_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
#include <octomap/OcTreeStamped.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <tuple>

#include "adapters/formats/files/input_error.h"

namespace prospect::octree_file_test {
namespace {

using ::testing::HasSubstr;

using Leaves = std::map<std::tuple<int, int, int, unsigned>, float>;

Leaves leaves(const octomap::OcTree& tree) {
  Leaves out;
  for (auto it = tree.begin_leafs(), end = tree.end_leafs(); it != end; ++it) {
    const octomap::OcTreeKey key = it.getIndexKey();
    out[{key[0], key[1], key[2], it.getDepth()}] = it->getLogOdds();
  }
  return out;
}

/// A room with a box in it, with leaves of several sizes and log-odds of all kinds.
octomap::OcTree room(bool graded) {
  octomap::OcTree tree(0.1);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> odds(-1.9f, 3.4f);
  for (int i = -20; i < 20; ++i) {
    for (int j = -16; j < 16; ++j) {
      for (int k = 0; k < 12; ++k) {
        const bool wall = i == -20 || i == 19 || k == 0 || (i > 3 && i < 8 && j > 0 && j < 6);
        const octomap::OcTreeKey key(static_cast<octomap::key_type>(32768 + i),
                                     static_cast<octomap::key_type>(32768 + j),
                                     static_cast<octomap::key_type>(32768 + k));
        tree.setNodeValue(key, graded ? odds(random) : wall ? 3.5f : -2.0f);
      }
    }
  }
  if (!graded) tree.toMaxLikelihood();
  tree.prune();
  return tree;
}

std::string bytes_of(const octomap::OcTree& tree, bool binary) {
  std::ostringstream out(std::ios::binary);
  if (binary) {
    tree.writeBinaryConst(out);
  } else {
    tree.write(out);
  }
  return out.str();
}

/// Everything a caller may rely on of a tree that was accepted.
void expect_sound(const octomap::OcTree& tree) {
  std::size_t nodes = 0;
  for (auto it = tree.begin_tree(), end = tree.end_tree(); it != end; ++it) {
    ASSERT_TRUE(std::isfinite(it->getLogOdds()));
    ASSERT_LE(it.getDepth(), 16u);
    ++nodes;
  }
  ASSERT_EQ(nodes, tree.size());
  ASSERT_TRUE(std::isfinite(tree.getResolution()));
}

/// True if accepted; a refusal must be one line that names the source and what was expected.
bool accepts(const std::string& bytes) {
  try {
    const auto tree = parse_octree(bytes, "x.bt");
    expect_sound(*tree);
    return true;
  } catch (const InputError& e) {
    EXPECT_EQ(e.lines().size(), 1u);
    EXPECT_THAT(e.what(), ::testing::StartsWith("x.bt"));
    EXPECT_THAT(e.what(), HasSubstr("expected"));
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    return false;
  }
}

std::size_t data_offset(const std::string& bytes) { return bytes.find("\ndata\n") + 6; }

TEST(OctreeFile, ReadsWhatTheLibraryWrote) {
  for (const bool binary : {true, false}) {
    const octomap::OcTree tree = room(!binary);
    const auto read = parse_octree(bytes_of(tree, binary), "x");
    EXPECT_EQ(leaves(*read), leaves(tree));
    EXPECT_EQ(read->size(), tree.size());
    EXPECT_EQ(read->getResolution(), tree.getResolution());
    expect_sound(*read);
  }
}

TEST(OctreeFile, EmptyTreeIsATree) {
  const octomap::OcTree tree(0.1);
  for (const bool binary : {true, false}) {
    EXPECT_EQ(parse_octree(bytes_of(tree, binary), "x")->size(), 0u);
  }
}

TEST(OctreeFile, InnerNodesHoldTheMaximumOfTheirChildren) {
  const auto tree = parse_octree(bytes_of(room(false), true), "x");
  for (auto it = tree->begin_tree(), end = tree->end_tree(); it != end; ++it) {
    if (it.isLeaf()) continue;
    ASSERT_EQ(it->getLogOdds(), it->getMaxChildLogOdds());
  }
}

TEST(OctreeFile, EveryTruncationIsRefused) {
  for (const bool binary : {true, false}) {
    const std::string bytes = bytes_of(room(!binary), binary);
    for (std::size_t n = 0; n < bytes.size(); n += n < 200 ? 1 : 97) {
      ASSERT_FALSE(accepts(bytes.substr(0, n))) << n << " of " << bytes.size();
    }
    EXPECT_FALSE(accepts(bytes + "x"));
    EXPECT_TRUE(accepts(bytes));
  }
}

TEST(OctreeFile, FlippedBitsAreRefusedOrHarmless) {
  for (const bool binary : {true, false}) {
    const octomap::OcTree original = room(!binary);
    const std::string bytes = bytes_of(original, binary);
    const std::size_t data = data_offset(bytes);
    std::mt19937_64 random(11);
    int structural_accepted = 0, accepted = 0;
    for (int n = 0; n < 700; ++n) {
      std::string bad = bytes;
      const std::size_t at = n < 250 ? random() % data : data + random() % (bytes.size() - data);
      bad[at] = static_cast<char>(bad[at] ^ (1 << random() % 8));
      if (!accepts(bad)) continue;
      ++accepted;
      // One flipped bit of a child mask changes the number of nodes, so it must have been noticed.
      const bool child_mask = !binary && at >= data && (at - data) % 5 == 4;
      structural_accepted += child_mask;
    }
    EXPECT_EQ(structural_accepted, 0);
    EXPECT_LT(accepted, 700);
  }
}

TEST(OctreeFile, NonFiniteLogOddsAreRefused) {
  std::string bytes = bytes_of(room(true), false);
  const std::size_t data = data_offset(bytes);
  for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    std::memcpy(bytes.data() + data + 10, &bad, sizeof(bad));
    EXPECT_FALSE(accepts(bytes));
  }
}

TEST(OctreeFile, BytesThatCrashTheLibraryAreRefused) {
  const std::string header = "# Octomap OcTree binary file\nid OcTree\nsize ";
  for (const char* size :
       {"1", "16", "17", "200000", "39999999", "99999999999999999999", "-1", "x"}) {
    for (const std::string& body : {std::string(200000, '\xff'), std::string(100, '\xff'),
                                    std::string(100, '\0'), std::string()}) {
      EXPECT_FALSE(accepts(header + size + "\nres 0.1\ndata\n" + body)) << size;
    }
  }
  EXPECT_FALSE(accepts(std::string(200000, '\xff')));
  EXPECT_FALSE(accepts("# Octomap OcTree binary file"));
  EXPECT_FALSE(accepts("# Octomap OcTree binary file\n" + std::string(1 << 20, '#')));
}

TEST(OctreeFile, DepthIsBounded) {
  // A chain of inner nodes: child 0 is inner at each level, 16 levels are legal, 17 are not.
  for (const int levels : {15, 16}) {
    std::string body;
    for (int n = 0; n < levels; ++n) body += std::string("\x03\x00", 2);
    body += std::string("\x01\x00", 2);  // a free leaf
    const std::string text = "# Octomap OcTree binary file\nid OcTree\nsize " +
                             std::to_string(levels + 2) + "\nres 0.1\ndata\n" + body;
    EXPECT_EQ(accepts(text), levels == 15) << levels;
  }
}

TEST(OctreeFile, BadHeadersAreRefused) {
  const std::string good = bytes_of(room(false), true);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos);
    return text.replace(at, from.size(), to);
  };
  for (const char* res :
       {"res nan", "res inf", "res 0", "res -0.1", "res 1e-9", "res 1e9", "res", "res x"}) {
    EXPECT_FALSE(accepts(with("res 0.1", res))) << res;
  }
  EXPECT_FALSE(accepts(with("id OcTree", "id CountingOcTree")));
  EXPECT_FALSE(accepts(with("id OcTree\n", "")));
  EXPECT_FALSE(accepts(with("id OcTree\n", "id OcTree\nid OcTree\n")));
  EXPECT_FALSE(accepts(with("id OcTree", "is OcTree")));
  EXPECT_TRUE(accepts(with("id OcTree", "# a comment\r\nid OcTree")));
}

TEST(OctreeFile, ColouredAndStampedTreesHaveTheSameLeaves) {
  const octomap::OcTree plain = room(false);
  octomap::ColorOcTree coloured(0.1);
  octomap::OcTreeStamped stamped(0.1);
  for (auto it = plain.begin_leafs(16), end = plain.end_leafs(); it != end; ++it) {
    // Of pruned leaves, each voxel.
    const int size = 1 << (16 - it.getDepth());
    for (int n = 0; n < size * size * size; ++n) {
      const octomap::OcTreeKey low = it.getIndexKey();
      const octomap::OcTreeKey key(static_cast<octomap::key_type>(low[0] + n % size),
                                   static_cast<octomap::key_type>(low[1] + n / size % size),
                                   static_cast<octomap::key_type>(low[2] + n / size / size));
      coloured.setNodeValue(key, it->getLogOdds())
          ->setColor(static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(key[0]), 7);
      stamped.setNodeValue(key, it->getLogOdds());
    }
  }
  stamped.prune();
  const auto same = [&](const octomap::AbstractOccupancyOcTree& tree, bool binary) {
    std::ostringstream out(std::ios::binary);
    if (binary) {
      tree.writeBinaryConst(out);
    } else {
      tree.write(out);
    }
    LeftOut left_out;
    const auto read = parse_octree(out.str(), "x", {}, &left_out);
    octomap::OcTree both = *read;
    both.prune();
    EXPECT_EQ(leaves(both), leaves(plain)) << tree.getTreeType() << binary;
    const bool colours = tree.getTreeType() == "ColorOcTree" && !binary;
    EXPECT_EQ(left_out.text(), colours ? "colours of voxels" : "");
    // Cut anywhere, it is refused.
    for (std::size_t n = 1; n < out.str().size(); n += 1 + out.str().size() / 50) {
      EXPECT_FALSE(accepts(out.str().substr(0, n)));
    }
  };
  for (const bool binary : {true, false}) {
    same(coloured, binary);
    same(stamped, binary);
  }
  EXPECT_FALSE(accepts("# Octomap OcTree file\nid SemanticOcTree\nsize 0\nres 0.1\ndata\n"));
}

TEST(OctreeFile, LimitsHold) {
  const std::string bytes = bytes_of(room(false), true);
  OctreeLimits limits;
  limits.max_nodes = 100;
  EXPECT_THROW(parse_octree(bytes, "x", limits), InputError);
  const std::string path = ::testing::TempDir() + "/limits.bt";
  write_octree(room(false), path);
  limits = {};
  limits.max_bytes = 100;
  EXPECT_THROW(read_octree(path, limits), InputError);
  std::filesystem::remove(path);
}

TEST(OctreeFile, BadPathsGiveOneLine) {
  const std::string folder = ::testing::TempDir();
  const std::string empty = folder + "/empty.bt";
  std::ofstream(empty).close();
  for (const std::string& path : {folder, folder + "/absent.bt", empty, std::string("/dev/zero")}) {
    try {
      read_octree(path);
      FAIL() << path;
    } catch (const InputError& e) {
      EXPECT_EQ(e.lines().size(), 1u);
      EXPECT_THAT(e.what(), HasSubstr(path + ": "));
    }
  }
  std::filesystem::remove(empty);
}

TEST(OctreeFile, WritingIsAtomicAndReadsBack) {
  const std::string path = ::testing::TempDir() + "/written.bt";
  const octomap::OcTree tree = room(false);
  write_octree(tree, path);
  EXPECT_EQ(leaves(*read_octree(path)), leaves(tree));
  EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
  octomap::OcTree by_library(1.0);
  ASSERT_TRUE(by_library.readBinary(path));
  EXPECT_EQ(leaves(by_library), leaves(tree));
  std::filesystem::remove(path);
  EXPECT_THROW(write_octree(tree, ::testing::TempDir() + "/no/such/folder/x.bt"), InputError);
}

class RealMaps : public ::testing::TestWithParam<const char*> {};

TEST_P(RealMaps, HaveTheLeavesOfTheLibrarysReader) {
  const std::string path = std::string(PROSPECT_SHARED_DATA) + "/octomap/" + GetParam();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data: " << path;
  const auto tree = read_octree(path);
  octomap::OcTree reference(1.0);
  ASSERT_TRUE(reference.readBinary(path));
  EXPECT_EQ(tree->getResolution(), reference.getResolution());
  ASSERT_EQ(tree->size(), reference.size());
  auto a = tree->begin_leafs();
  auto b = reference.begin_leafs();
  std::size_t count = 0;
  for (; a != tree->end_leafs() && b != reference.end_leafs(); ++a, ++b, ++count) {
    ASSERT_EQ(a.getIndexKey(), b.getIndexKey());
    ASSERT_EQ(a.getDepth(), b.getDepth());
    ASSERT_EQ(a->getLogOdds(), b->getLogOdds());
  }
  EXPECT_TRUE(a == tree->end_leafs() && b == reference.end_leafs());
  EXPECT_GT(count, 1000u);
}

INSTANTIATE_TEST_SUITE_P(Data, RealMaps,
                         ::testing::Values("fr_079/fr_079.bt", "fr_078_tidyup/fr_078_tidyup.bt",
                                           "geb079/geb079.bt", "dw_nav2/map.bt"));

}  // namespace
}  // namespace prospect::octree_file_test
