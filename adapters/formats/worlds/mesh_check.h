// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace prospect {

// What Assimp would read wrong without a word, in the files of meshes that state how much they
// hold. Each throws InputError, one line that begins with `source`.

/// An STL, ASCII or binary: whole, to the last facet. A binary one may begin with "solid".
void check_stl(std::string_view bytes, const std::string& source);

/// A PLY: whole, by the numbers of elements in its header, and with faces.
void check_ply(std::string_view bytes, const std::string& source);

/// A COLLADA: its unit is a positive length.
void check_collada(std::string_view bytes, const std::string& source);

}  // namespace prospect
