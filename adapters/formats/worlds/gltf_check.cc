// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/gltf_check.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

using nlohmann::json;

/// The JSON of a .gltf, or of the first chunk of a .glb.
std::string_view json_of(std::string_view bytes, const std::string& source) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (bytes.starts_with(kByteOrderMark)) {
    fail(source, "begins with a byte order mark, which glTF forbids; expected none");
  }
  if (!bytes.starts_with("glTF")) return bytes;
  constexpr std::size_t kHead = 20;  // of the file and of its first chunk
  std::uint32_t length = 0;
  if (bytes.size() < kHead) fail(source, "truncated binary glTF; expected its JSON chunk first");
  std::memcpy(&length, bytes.data() + 12, sizeof length);
  if (bytes.substr(16, 4) != "JSON" || length > bytes.size() - kHead) {
    fail(source, "truncated or corrupt binary glTF; expected its JSON chunk first");
  }
  return bytes.substr(kHead, length);
}

json list(const json& parent, const char* key) {
  if (!parent.is_object()) return json::array();
  const auto found = parent.find(key);
  return found != parent.end() && found->is_array() ? *found : json::array();
}

/// Extensions that say how surfaces look, or where lights are, not where the surfaces are.
bool is_harmless(const std::string& name) {
  return name.starts_with("KHR_materials_") || name == "KHR_lights_punctual" ||
         name == "KHR_texture_transform";
}

/// Extensions that change where surfaces are.
bool moves_surfaces(const std::string& name) {
  static const std::set<std::string> kMoving = {"EXT_mesh_gpu_instancing", "KHR_mesh_quantization",
                                                "KHR_draco_mesh_compression"};
  return kMoving.count(name) > 0;
}

[[noreturn]] void refuse_used(const std::string& source, const std::string& name) {
  fail(source, "the glTF uses " + in_quotes(name) +
                   ", not supported; expected each copy as a node of its own, and positions as "
                   "float, not compressed");
}

void check_version(const json& root, const std::string& source) {
  const json asset = root.value("asset", json::object());
  for (const char* key : {"version", "minVersion"}) {
    if (!asset.is_object() || !asset.contains(key)) continue;
    const std::string version = asset[key].is_string() ? asset[key].get<std::string>() : "?";
    const bool good = key[0] == 'v' ? version.starts_with("2.") : version == "2.0";
    if (!good) fail(source, "a glTF of version " + in_quotes(version) + "; expected 2.0");
  }
  if (!asset.is_object() || !asset.contains("version")) {
    fail(source, "no asset.version; expected a glTF of version 2.0");
  }
}

void check_extensions(const json& root, const std::string& source, LeftOut& left_out) {
  std::string unknown;
  for (const json& name : list(root, "extensionsRequired")) {
    if (!name.is_string() || is_harmless(name.get<std::string>())) continue;
    unknown += (unknown.empty() ? "" : ", ") + in_quotes(name.get<std::string>());
  }
  if (!unknown.empty()) {
    fail(source, "the glTF requires " + unknown.substr(0, 500) +
                     ", not supported; expected a plain glTF, without compression or quantisation");
  }
  for (const json& item : list(root, "extensionsUsed")) {
    if (!item.is_string()) continue;
    const auto name = item.get<std::string>();
    if (moves_surfaces(name)) refuse_used(source, name);
    if (name == "KHR_texture_transform") {
      left_out.name("texture transforms");
    } else if (name == "KHR_lights_punctual") {
      left_out.name("lights");
    } else if (!is_harmless(name)) {
      left_out.name("extension " + in_quotes(name));
    }
  }
  // Files have been seen that use what they do not list.
  const auto look = [&](const json& holder) {
    if (!holder.is_object() || !holder.contains("extensions")) return;
    const json& extensions = holder["extensions"];
    if (!extensions.is_object()) return;
    for (const auto& [name, content] : extensions.items()) {
      if (moves_surfaces(name)) refuse_used(source, name);
    }
  };
  for (const json& node : list(root, "nodes")) look(node);
  for (const json& mesh : list(root, "meshes")) {
    for (const json& primitive : list(mesh, "primitives")) look(primitive);
  }
}

void check_numbers(const json& root, const std::string& source) {
  const json accessors = list(root, "accessors");
  constexpr int kFloat = 5126;
  const auto type_of = [&](const json& index) {
    if (!index.is_number_unsigned() || index.get<std::size_t>() >= accessors.size()) return kFloat;
    const json& accessor = accessors[index.get<std::size_t>()];
    return accessor.is_object() && accessor.contains("componentType") &&
                   accessor["componentType"].is_number_integer()
               ? accessor["componentType"].get<int>()
               : kFloat;
  };
  for (const json& mesh : list(root, "meshes")) {
    for (const json& primitive : list(mesh, "primitives")) {
      if (!primitive.is_object() || !primitive.contains("attributes")) continue;
      if (!primitive["attributes"].is_object()) continue;
      for (const auto& [attribute, index] : primitive["attributes"].items()) {
        if (attribute != "POSITION" && attribute != "TEXCOORD_0") continue;
        const int type = type_of(index);
        if (type == kFloat) continue;
        fail(source, attribute + " of component type " + std::to_string(type) +
                         (type == 5122 || type == 5123   ? " (16 bits)"
                          : type == 5120 || type == 5121 ? " (8 bits)"
                                                         : "") +
                         " is not supported; expected float (5126)");
      }
    }
  }
}

}  // namespace

void check_gltf(std::string_view bytes, const std::string& source, LeftOut& left_out) {
  const json root = json::parse(json_of(bytes, source), nullptr, false);
  if (root.is_discarded() || !root.is_object()) {
    fail(source, "no whole JSON; expected a glTF of version 2.0");
  }
  check_version(root, source);
  check_extensions(root, source, left_out);
  check_numbers(root, source);
  const std::size_t scenes = list(root, "scenes").size();
  if (scenes > 1) left_out.count("further scene", scenes - 1);
}

}  // namespace prospect
