// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/raw_type.h"

#ifdef PROSPECT_WITH_CYCLONEDDS

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>

namespace prospect {
namespace {

struct RawSample : ddsi_serdata {
  RawSample(const ddsi_sertype* type, ddsi_serdata_kind kind) {
    ddsi_serdata_init(this, type, kind);
    hash = type->serdata_basehash;  // one instance, as there is no key
  }
  /// Of `count` bytes, and zeros up to a multiple of four, which the protocol sends.
  void resize(std::size_t count) {
    size = count;
    bytes.resize((count + 3) / 4 * 4, '\0');
  }
  std::size_t size = 0;
  std::string bytes;
};

const RawSample* raw(const ddsi_serdata* d) { return static_cast<const RawSample*>(d); }

// What the library calls is C: an exception would end the program, so a failure is a null pointer.
template <typename Make>
ddsi_serdata* made(const Make& make) noexcept {
  try {
    return make().release();
  } catch (...) {
    return nullptr;
  }
}

ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* part,
                             size_t size) {
  return made([&] {
    auto sample = std::make_unique<RawSample>(type, kind);
    sample->resize(size);
    std::size_t at = 0;
    for (; part != nullptr; part = part->nextfrag) {
      if (part->maxp1 <= at || part->min > at) continue;
      const unsigned char* payload = NN_RMSG_PAYLOADOFF(part->rmsg, NN_RDATA_PAYLOAD_OFF(part));
      const std::size_t end = std::min<std::size_t>(part->maxp1, size);
      if (end <= at) break;
      std::memcpy(sample->bytes.data() + at, payload + (at - part->min), end - at);
      at = end;
    }
    return sample;
  });
}

ddsi_serdata* from_vectors(const ddsi_sertype* type, ddsi_serdata_kind kind,
                           ddsrt_msg_iovlen_t count, const ddsrt_iovec_t* vectors, size_t size) {
  return made([&] {
    auto sample = std::make_unique<RawSample>(type, kind);
    sample->resize(size);
    std::size_t at = 0;
    for (ddsrt_msg_iovlen_t i = 0; i < count && at < size; ++i) {
      const std::size_t part = std::min<std::size_t>(vectors[i].iov_len, size - at);
      std::memcpy(sample->bytes.data() + at, vectors[i].iov_base, part);
      at += part;
    }
    return sample;
  });
}

ddsi_serdata* from_key(const ddsi_sertype* type, const ddsi_keyhash*) {
  return made([&] { return std::make_unique<RawSample>(type, SDK_KEY); });
}

ddsi_serdata* from_bytes(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* bytes) {
  return made([&] {
    auto sample = std::make_unique<RawSample>(type, kind);
    if (kind == SDK_DATA) {
      sample->bytes = *static_cast<const std::string*>(bytes);
      sample->resize(sample->bytes.size());
    }
    return sample;
  });
}

void copy(const ddsi_serdata* d, size_t from, size_t size, void* out) {
  std::memcpy(out, raw(d)->bytes.data() + from, size);
}

ddsi_serdata* lend(const ddsi_serdata* d, size_t from, size_t size, ddsrt_iovec_t* out) {
  out->iov_base = const_cast<char*>(raw(d)->bytes.data()) + from;
  out->iov_len = size;
  return ddsi_serdata_ref(d);
}

const ddsi_serdata_ops kSampleOperations = {
    .eqkey = [](const ddsi_serdata*, const ddsi_serdata*) { return true; },
    .get_size = [](const ddsi_serdata* d) { return static_cast<uint32_t>(raw(d)->size); },
    .from_ser = from_fragments,
    .from_ser_iov = from_vectors,
    .from_keyhash = from_key,
    .from_sample = from_bytes,
    .to_ser = copy,
    .to_ser_ref = lend,
    .to_ser_unref = [](ddsi_serdata* d, const ddsrt_iovec_t*) { ddsi_serdata_unref(d); },
    .to_sample = [](const ddsi_serdata*, void*, void**, void*) { return false; },
    .to_untyped =
        [](const ddsi_serdata* d) {
          return made([&] {
            auto key = std::make_unique<RawSample>(d->type, SDK_KEY);
            key->type = nullptr;
            return key;
          });
        },
    .untyped_to_sample = [](const ddsi_sertype*, const ddsi_serdata*, void*, void**,
                            void*) { return false; },
    .free = [](ddsi_serdata* d) { delete static_cast<RawSample*>(d); },
    .print =
        [](const ddsi_sertype*, const ddsi_serdata* d, char* out, size_t size) {
          const int length = std::snprintf(out, size, "%zu bytes", raw(d)->size);
          return static_cast<size_t>(std::max(0, length));
        },
    .get_keyhash = [](const ddsi_serdata*, ddsi_keyhash* out,
                      bool) { std::memset(out, 0, sizeof *out); },
#ifdef DDS_HAS_SHM
    .get_sample_size = [](const ddsi_serdata* d) { return static_cast<uint32_t>(raw(d)->size); },
    .from_iox_buffer = [](const ddsi_sertype*, ddsi_serdata_kind, void*, void*) -> ddsi_serdata* {
      return nullptr;
    },
#endif
};

const ddsi_sertype_ops kTypeOperations = {
    .version = ddsi_sertype_v0,
    .arg = nullptr,
    .free =
        [](ddsi_sertype* type) {
          ddsi_sertype_fini(type);
          delete type;
        },
    .zero_samples = [](const ddsi_sertype*, void*, size_t) {},
    .realloc_samples = [](void** out, const ddsi_sertype*, void*, size_t,
                          size_t) { *out = nullptr; },
    .free_samples = [](const ddsi_sertype*, void**, size_t, dds_free_op_t) {},
    .equal = [](const ddsi_sertype*, const ddsi_sertype*) { return true; },
    .hash = [](const ddsi_sertype*) -> uint32_t { return 0; },
    .type_id = nullptr,
    .type_map = nullptr,
    .type_info = nullptr,
    .derive_sertype = nullptr,
    .get_serialized_size = nullptr,
    .serialize_into = nullptr,
};

}  // namespace

ddsi_sertype* make_raw_type(const std::string& name) {
  auto type = std::make_unique<ddsi_sertype>();
  ddsi_sertype_init(type.get(), name.c_str(), &kTypeOperations, &kSampleOperations, true);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type.release();
}

void free_raw_type(ddsi_sertype* type) { ddsi_sertype_unref(type); }

std::string_view bytes_of(const ddsi_serdata* sample) {
  return std::string_view(raw(sample)->bytes).substr(0, raw(sample)->size);
}

}  // namespace prospect

#endif
