// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

struct ddsi_sertype;
struct ddsi_serdata;

namespace prospect {

/// A type of CycloneDDS whose samples are bytes in CDR as they go over the wire, without a key:
/// what is written is a std::string with the head of CDR, what is taken (dds_takecdr) is a view of
/// the bytes that came. Nothing of them is judged here. `name`: of the type in DDS. It belongs to
/// the topic that is created with it, or to free_raw_type().
ddsi_sertype* make_raw_type(const std::string& name);
void free_raw_type(ddsi_sertype* type);

/// The bytes of a sample that was taken, while it is held.
std::string_view bytes_of(const ddsi_serdata* sample);

}  // namespace prospect
