#pragma once

#include <string>

#include "adapters/formats/worlds/left_out.h"

namespace prospect {

/// A COLLADA in the spelling that Assimp takes, with the same surfaces:
///  * white space about texts and attributes goes, and comments within numbers, which XML lists do
///    not count;
///  * polygons with holes (<ph>) are <triangles>;
///  * cameras and lights go, and are told in left_out: Assimp refuses two of them on one node.
/// Text that is no XML comes back as it is. There only where TinyXML-2 is.
std::string plain_collada(std::string text, LeftOut& left_out);

}  // namespace prospect
