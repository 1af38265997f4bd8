// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/program/cli/command_description.h"

namespace prospect {

/// Completion of the program's commands, options and values, as each shell reads it from a file:
/// share/bash-completion/completions/prospect, share/zsh/site-functions/_prospect,
/// share/fish/vendor_completions.d/prospect.fish. Values of the program's types by words_of().
std::string bash_completion(const CommandDescription& program, const TypeWords& types);
std::string zsh_completion(const CommandDescription& program, const TypeWords& types);
std::string fish_completion(const CommandDescription& program, const TypeWords& types);

}  // namespace prospect
