// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/gltf_check.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>

#include "adapters/formats/files/input_error.h"

namespace prospect::gltf_check_test {
namespace {

/// What is wrong with a glTF that also holds `more`, or what is left out of it.
std::string verdict(const std::string& bytes) {
  LeftOut left_out;
  try {
    check_gltf(bytes, "a.gltf", left_out);
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1u);
    return error.what();
  }
  return left_out.text();
}

std::string gltf(const std::string& more, const std::string& version = "2.0") {
  return R"({"asset":{"version":")" + version + R"("})" + (more.empty() ? "" : "," + more) + "}";
}

TEST(GltfCheck, WhatIsWrongIsNamed) {
  const std::pair<std::string, std::string> cases[] = {
      {gltf(""), ""},
      {gltf("", "2.1"), ""},
      {gltf("", "1.0"), "version '1.0'"},
      {R"({"asset":{"version":"2.1","minVersion":"2.1"}})", "version '2.1'"},
      {R"({"asset":{"version":2.0}})", "version '?'"},
      {"{}", "no asset.version"},
      {"[]", "no whole JSON"},
      {R"({"asset":)", "no whole JSON"},
      {std::string(200000, '['), "no whole JSON"},
      {"\xef\xbb\xbf" + gltf(""), "byte order mark"},
      // Required and not known; used, though not listed.
      {gltf(R"("extensionsRequired":["KHR_texture_basisu"])"), "requires 'KHR_texture_basisu'"},
      {gltf(R"("extensionsRequired":["CESIUM_RTC","KHR_materials_unlit"])"),
       "requires 'CESIUM_RTC',"},
      {gltf(R"("extensionsRequired":["KHR_materials_unlit"])"), ""},
      {gltf(R"("extensionsUsed":["KHR_draco_mesh_compression"])"), "uses 'KHR_draco"},
      {gltf(R"("nodes":[{"extensions":{"EXT_mesh_gpu_instancing":{}}}])"), "uses 'EXT_mesh_gpu"},
      {gltf(R"("meshes":[{"primitives":[{"extensions":{"KHR_draco_mesh_compression":{}}}]}])"),
       "uses 'KHR_draco"},
      // Told.
      {gltf(R"("extensionsUsed":["EXT_texture_webp","MSFT_lod","KHR_materials_ior"])"),
       "extension 'EXT_texture_webp', extension 'MSFT_lod'"},
      {gltf(R"("scenes":[{},{},{}])"), "2 further scenes"},
      // Other numbers than float.
      {gltf(R"("accessors":[{"componentType":5130}],"meshes":[{"primitives":[{"attributes":)"
            R"({"POSITION":0}}]}])"),
       "POSITION of component type 5130"},
      {gltf(R"("accessors":[{"componentType":5121}],"meshes":[{"primitives":[{"attributes":)"
            R"({"TEXCOORD_0":0}}]}])"),
       "TEXCOORD_0 of component type 5121 (8 bits)"},
      {gltf(R"("accessors":[{"componentType":5121}],"meshes":[{"primitives":[{"attributes":)"
            R"({"COLOR_0":0,"POSITION":7}}]}])"),
       ""},
      // Of other types than they should be.
      {gltf(R"("extensionsUsed":{"a":1},"extensionsRequired":[1],"nodes":[1],"meshes":[[]])"), ""},
      {gltf(R"("meshes":[{"primitives":{"attributes":1}}],"accessors":3,"scenes":"x")"), ""}};
  for (const auto& [bytes, expected] : cases) {
    const std::string found = verdict(bytes);
    if (expected.empty()) {
      EXPECT_EQ(found, "") << bytes;
    } else {
      EXPECT_NE(found.find(expected), std::string::npos) << found << "\n" << bytes.substr(0, 200);
    }
  }
}

TEST(GltfCheck, BinaryFilesAreCheckedByTheirFirstChunk) {
  const std::string json = gltf(R"("extensionsUsed":["MSFT_lod"])");
  const auto word = [](std::uint32_t n) {
    return std::string(reinterpret_cast<const char*>(&n), sizeof n);
  };
  const auto size = static_cast<std::uint32_t>(json.size());
  const std::string head = "glTF" + word(2) + word(20 + size);
  EXPECT_EQ(verdict(head + word(size) + "JSON" + json), "extension 'MSFT_lod'");
  for (const std::string& torn :
       {std::string("glTF"), head + word(size + 1) + "JSON" + json,
        head + word(size) + "BIN." + json, head + word(0xffffffff) + "JSON" + json}) {
    EXPECT_NE(verdict(torn).find("binary glTF; expected"), std::string::npos);
  }
}

}  // namespace
}  // namespace prospect::gltf_check_test
