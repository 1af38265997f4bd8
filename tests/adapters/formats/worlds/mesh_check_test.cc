// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/mesh_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <utility>

#include "adapters/formats/files/input_error.h"

namespace prospect::mesh_check_test {
namespace {

using Check = std::function<void(std::string_view, const std::string&)>;

std::string problem(const Check& check, const std::string& bytes) {
  try {
    check(bytes, "a.mesh");
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1u);
    return error.what();
  }
  return "";
}

void expect(const Check& check, const std::string& bytes, const std::string& what) {
  const std::string found = problem(check, bytes);
  if (what.empty()) {
    EXPECT_EQ(found, "");
  } else {
    EXPECT_NE(found.find(what), std::string::npos) << found;
  }
}

std::string binary_stl(std::uint32_t said, std::size_t held, const std::string& name) {
  std::string bytes = name + std::string(80 - name.size(), ' ');
  bytes.append(reinterpret_cast<const char*>(&said), sizeof said);
  return bytes + std::string(50 * held, '\0');
}

TEST(MeshCheck, StlIsWhole) {
  const std::string facet =
      "  facet normal 0 0 1\n outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n";
  const std::string whole = "solid a facet\n" + facet + "endfacet\nendsolid a facet\n";
  expect(check_stl, whole, "");
  expect(check_stl, whole + whole, "");
  std::string windows = whole;
  for (std::size_t at = 0; (at = windows.find('\n', at)) != std::string::npos; at += 2) {
    windows.insert(at, 1, '\r');
  }
  expect(check_stl, windows, "");
  expect(check_stl, "solid\nendsolid\n", "");
  expect(check_stl, "solid a\n" + facet + "endfacet\n" + facet, "2 facets begin and 1 end");
  expect(check_stl, "solid a\n" + facet + "endfacet\n", "with endsolid");
  expect(check_stl, binary_stl(3, 3, "made by a program"), "");
  expect(check_stl, binary_stl(3, 3, "solid, though binary"), "");
  expect(check_stl, binary_stl(3, 2, "torn"), "184 bytes; expected 234 for the 3 triangles");
  expect(check_stl, binary_stl(3, 2, "solid and torn"), "184 bytes; expected 234");
  expect(check_stl, binary_stl(0xffffffff, 1, "boasts"), "4294967295 triangles");
  expect(check_stl, binary_stl(1, 1, "more") + "x", "135 bytes");
  expect(check_stl, "SOLID", "5 bytes");
  expect(check_stl, "SOLID A\nFACET NORMAL 0 0 1\n", "in capitals");
  expect(check_stl, "", "0 bytes");
}

/// Three points and a face, and a line of whatever else the header says.
std::string ply(const std::string& format, const std::string& data, const std::string& faces = "1",
                const std::string& length = "uchar") {
  return "ply\nformat " + format +
         " 1.0\ncomment by a test\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nproperty uchar red\nelement face " +
         faces + "\nproperty list " + length + " int vertex_indices\nend_header\n" + data;
}

TEST(MeshCheck, PlyHoldsWhatItsHeaderSays) {
  const std::string points = "0 0 0 9\n1 0 0 9\n\n0 1 0 9\n";
  expect(check_ply, ply("ascii", points + "3 0 1 2\n"), "");
  expect(check_ply, ply("ascii", points + "3 0 1 2"), "");
  expect(check_ply, ply("ascii", points), "3 lines after the header; expected 4");
  expect(check_ply, ply("ascii", points, "99999999999999"), "expected 1099511627779");
  for (const bool big : {false, true}) {
    const std::string format = big ? "binary_big_endian" : "binary_little_endian";
    const auto word = [&](std::uint32_t n) {
      std::string bytes(reinterpret_cast<const char*>(&n), sizeof n);
      if (big) std::reverse(bytes.begin(), bytes.end());
      return bytes;
    };
    const std::string vertices(3 * 13, '\0');
    const std::string corners = word(0) + word(1) + word(2);
    expect(check_ply, ply(format, vertices + '\3' + corners), "");
    expect(check_ply, ply(format, vertices + word(3) + corners, "1", "uint"), "");
    expect(check_ply, ply(format, vertices + '\4' + corners), "ends within its 'face'");
    expect(check_ply, ply(format, vertices + '\3' + corners, "2"), "ends within its 'face'");
    expect(check_ply, ply(format, vertices.substr(1)), "ends within its 'vertex'");
    expect(check_ply, ply(format, vertices + '\3' + corners, "18446744073709551615"), "'face'");
    expect(check_ply, ply(format, vertices + word(0xffffffff) + corners, "1", "int"), "'face'");
    expect(check_ply, ply(format, vertices + word(0xffffffff) + corners, "1", "uint"), "'face'");
  }
  expect(check_ply, ply("ascii", points, "0"), "only points");
  expect(check_ply, ply("binary", points), "the format 'binary'");
  expect(check_ply, ply("ascii", points, "-1"), "a.mesh:9: the line 'element face -1'");
  expect(check_ply, ply("ascii", points, "1", "float"), "a.mesh:10: the line 'property list");
  expect(check_ply, "ply\nproperty float x\n", "a.mesh:2: the line");
  expect(check_ply, "ply\nformat ascii 1.0\n", "the header does not end");
  expect(check_ply, "solid\n", "expected 'ply'");
  expect(check_ply, "", "the header does not end");
}

TEST(MeshCheck, AColladaHasAPositiveUnit) {
  const std::pair<const char*, const char*> units[] = {
      {"", ""},
      {"<unit/>", ""},
      {"<unit name='meter' meter='1'/>", ""},
      {"<unit meter = \"0.0254\" name=\"inch\"/>", ""},
      {"<unit meter='0,01'/>", ""},
      {"<unit meter='1e-3'/>", ""},
      {"<unit name='meter' meter='0'/>", "a unit of '0' m"},
      {"<unit meter='-1'/>", "a unit of '-1' m"},
      {"<unit meter='nan'/>", "a unit of 'nan' m"},
      {"<unit meter='inch'/>", "a unit of 'inch' m"},
      {"<unit meter='1'/><unit meter=''/>", "a unit of '' m"},
      {"<unit meter='", "a unit of '' m"},
      {"<unit meter", ""}};
  for (const auto& [unit, what] : units) {
    expect(check_collada, "<COLLADA><asset>" + std::string(unit), what);
  }
}

}  // namespace
}  // namespace prospect::mesh_check_test
