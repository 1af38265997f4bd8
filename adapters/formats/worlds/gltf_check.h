// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "adapters/formats/worlds/left_out.h"

namespace prospect {

/// Looks into the JSON of a glTF (.gltf, or .glb, which begins with "glTF") for what Assimp would
/// read wrong without a word.
///
/// Throws InputError, one line that begins with `source`:
///  * no whole JSON, or another version than 2;
///  * a required extension that changes where surfaces are: quantised, compressed, and all that are
///    not known; the same if it is not required but used, by a node or a mesh;
///  * instances (EXT_mesh_gpu_instancing);
///  * positions or texture coordinates other than float.
/// Told in left_out: lights, texture transforms, other extensions that are used, scenes besides the
/// one that is shown.
void check_gltf(std::string_view bytes, const std::string& source, LeftOut& left_out);

}  // namespace prospect
