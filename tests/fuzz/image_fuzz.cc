// SPDX-License-Identifier: Apache-2.0
// An image of a recording: PNG, PGM and what else is read.
#include "adapters/formats/datasets/raw_image.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  fuzz::read_or_refuse([&] {
    const RawImage image = decode_image(bytes, "a.png");
    grey_image(image, significant_bits(image), "a.png");
  });
  return 0;
}
