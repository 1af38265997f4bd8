// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/formats/worlds/left_out.h"

namespace prospect {

/// A COLLADA in the spelling that Assimp takes, with the same surfaces:
///  * white space about texts and attributes goes, and comments within numbers, which XML lists do
///    not count;
///  * polygons with holes (<ph>) are <triangles>;
///  * cameras and lights go, and are told in left_out: Assimp refuses two of them on one node;
///  * an accessor counts what is in its array at most: Assimp asks the accessor alone whether an
///    index is within.
/// Text that is no XML comes back as it is. There only where TinyXML-2 is.
///
/// Throws InputError for indices that are no whole numbers, of which Assimp makes vertices without
/// end, and for an up_axis that is none. `source` stands for the file.
std::string plain_collada(std::string text, const std::string& source, LeftOut& left_out);

}  // namespace prospect
