// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/written_file.h"

#include "adapters/formats/files/input_error.h"

namespace prospect {

void write_file(OutputFolder& folder, const std::string& name, const std::string& content,
                const std::filesystem::path& path) {
  const std::string wrong = folder.write(name, content);
  if (!wrong.empty()) {
    throw InputError(path.string() + ": cannot be written (" + wrong +
                     "); expected a writable folder");
  }
}

}  // namespace prospect
