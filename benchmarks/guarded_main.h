// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <iostream>

#include "adapters/formats/files/input_error.h"

namespace prospect {

/// What main() of a measuring program returns: program(argc, argv), or 2 after bad input and 1
/// after any other exception, with one line "NAME: what happened" on the standard error.
template <typename Program>
int guarded_main(const char* name, const Program& program, int argc, char** argv) {
  try {
    return program(argc, argv);
  } catch (const InputError& e) {
    std::cerr << name << ": " << e.what() << '\n';
    return 2;
  } catch (const std::exception& e) {
    std::cerr << name << ": " << e.what() << '\n';
    return 1;
  }
}

}  // namespace prospect
