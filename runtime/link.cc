// SPDX-License-Identifier: Apache-2.0
#include "runtime/link.h"

#include "models/formatted.h"

namespace prospect {
namespace {

std::string or_dash(const std::string& text) { return text.empty() ? "-" : text; }
std::string or_dash(const std::optional<double>& seconds) {
  return seconds ? formatted("%g", *seconds) : "-";
}
std::string or_dash(const std::optional<DriveCause>& cause) {
  return cause ? std::string(to_string(*cause)) : "-";
}

std::string publishers(const Link& link) {
  if (link.most == 0) {
    return link.least == 0 ? "any" : formatted("%d or more", link.least);
  }
  return link.least == link.most ? formatted("%d", link.most)
                                 : formatted("%d to %d", link.least, link.most);
}

}  // namespace

std::string link_table(std::span<const Link> links) {
  std::string text =
      "Signals that safety rests on, and why the robot stops where they are not as they must "
      "be.\n\n"
      "| signal | topic | publishers | silence [s] | age [s] | frame | values | absent | too many "
      "| wrong |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Link& link : links) {
    const std::string topic = link.topic.empty() ? "none" : '`' + link.topic + '`';
    for (const std::string& cell :
         {link.signal, topic, publishers(link), or_dash(link.heartbeat), or_dash(link.age),
          or_dash(link.frame), or_dash(link.values), or_dash(link.absent), or_dash(link.doubled),
          or_dash(link.wrong)}) {
      text += "| " + cell + ' ';
    }
    text += "|\n";
  }
  return text;
}

}  // namespace prospect
