// SPDX-License-Identifier: Apache-2.0
// Rows of a run folder (CSV).
#include "adapters/views/report/step_table.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  fuzz::read_or_refuse([&] {
    const StepTable table = StepTable::parse(std::string(bytes), "steps.csv");
    for (const char* column : {"t", "x", "mode"}) {
      if (table.has(column)) table.numbers(column);
    }
  });
  return 0;
}
