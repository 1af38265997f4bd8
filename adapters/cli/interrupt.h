#pragma once

#include <functional>

namespace prospect {

/// From now on SIGINT, SIGTERM and SIGHUP no longer end the program; the function returned tells
/// whether one of them came. A SIGHUP that was ignored when the program started stays ignored. Call
/// before what is to be interrupted, once in a program.
std::function<bool()> catch_interrupts();

/// From now on SIGUSR1 is a person who acknowledges a stop that latches; the function returned
/// tells whether one has come since the call before.
std::function<bool()> catch_acknowledgements();

}  // namespace prospect
