// SPDX-License-Identifier: Apache-2.0
// A problem file (HDF5).
#include "adapters/formats/problem_file/problem_file.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  const std::string path = fuzz::folder().write("a.h5", bytes);
  fuzz::read_or_refuse<std::invalid_argument>([&] { read_problem(path); });
  return 0;
}
