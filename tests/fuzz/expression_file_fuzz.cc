// SPDX-License-Identifier: Apache-2.0
// Problems as expressions (JSON).
#include "adapters/missions/bench/expression_file.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  const std::string path = fuzz::folder().write("a.json", bytes);
  fuzz::read_or_refuse([&] { read_expression_file(path); });
  return 0;
}
