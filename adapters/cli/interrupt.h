#pragma once

#include <functional>

namespace prospect {

/// From now on SIGINT and SIGTERM no longer end the program; the function returned tells whether
/// one of them came. Call before what is to be interrupted, once in a program.
std::function<bool()> catch_interrupts();

}  // namespace prospect
