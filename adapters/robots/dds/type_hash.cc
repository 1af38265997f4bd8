// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/type_hash.h"

#include "adapters/formats/files/not_built_in.h"

#ifdef PROSPECT_WITH_CYCLONEDDS
#include <openssl/evp.h>

#include <array>
#include <stdexcept>
#endif

namespace prospect {

std::string type_hash(const std::vector<ros::MessageDefinition>& definition) {
#ifdef PROSPECT_WITH_CYCLONEDDS
  const std::string text = ros::hashed_text(definition);
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("OpenSSL makes no SHA-256");
  }
  constexpr char kDigits[] = "0123456789abcdef";
  std::string hash = "RIHS01_";
  for (unsigned int i = 0; i < size; ++i) {
    hash += kDigits[digest[i] >> 4];
    hash += kDigits[digest[i] & 15];
  }
  return hash;
#else
  static_cast<void>(definition);
  throw NotBuiltIn("ROS 2 over DDS", "cyclonedds-dev and libssl-dev");
#endif
}

}  // namespace prospect
