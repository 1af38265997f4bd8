// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/sdf_file.h"

#ifdef PROSPECT_WITH_ASSIMP

#include <tinyxml2.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "adapters/formats/files/input_error.h"

namespace prospect {

void read_sdf(const std::string& path, tinyxml2::XMLDocument& into) {
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw InputError(path + ": cannot be read; expected a Gazebo world or model");
  // TinyXML-2 takes a declaration as the first thing only.
  const std::size_t begin = text.find("<?xml"), end = text.find("?>", begin);
  if (begin > 0 && end != std::string::npos) {
    const auto at = [&](std::size_t n) { return text.begin() + static_cast<std::ptrdiff_t>(n); };
    std::replace_if(
        at(begin), at(end + 2), [](char c) { return c != '\n'; }, ' ');
  }
  if (into.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS) {
    throw InputError(path + ":" + std::to_string(into.ErrorLineNum()) + ": no whole XML (" +
                     into.ErrorName() + "); expected a Gazebo world or model");
  }
}

}  // namespace prospect

#endif
