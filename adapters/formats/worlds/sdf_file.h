// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace tinyxml2 {
class XMLDocument;
}

namespace prospect {

/// Reads an SDF as Gazebo does: comments may come before its XML declaration. Lines are those of
/// the file. Throws InputError with file and line where it cannot be read or is no whole XML. There
/// only where TinyXML-2 is.
void read_sdf(const std::string& path, tinyxml2::XMLDocument& into);

}  // namespace prospect
