// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace prospect {

// Who may watch and who may command. Pure functions but for make_token().

/// 128 bits of the system's randomness as 32 hexadecimal digits. Throws std::runtime_error if the
/// system gives none.
std::string make_token();

/// What is wrong with a token that somebody chose; empty: nothing.
std::string token_fault(std::string_view token);

/// Whether both are the same. Takes the same time wherever they differ.
bool same_token(std::string_view a, std::string_view b);

/// The value of a key in the query of a request's target, "/?token=abc"; empty if there is none.
/// Nothing is decoded: a token needs no escapes.
std::string_view query_value(std::string_view target, std::string_view key);

/// Whether the Host header of a request names this server by something that nobody else's name
/// server can point at it: an address, "localhost", or the machine's own name, with or without
/// ".local". A page of a stranger that has its name resolved to this machine sends that name.
bool is_own_host(std::string_view host, std::string_view machine);

/// Whether a page that was served under this Host header has this Origin.
bool is_same_origin(std::string_view origin, std::string_view host);

}  // namespace prospect
