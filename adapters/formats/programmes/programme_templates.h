// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Parts of the files of C that c_writer.h writes; the files beside this one.
namespace prospect::programme_templates {

std::string_view interface_head();
std::string_view interface_functions();
std::string_view expression_values();
std::string_view file_values();
std::string_view family_values();

}  // namespace prospect::programme_templates
