// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/bags/decompression.h"

#include <memory>
#include <utility>
#ifdef PROSPECT_WITH_LZ4
#include <lz4frame.h>
#endif
#ifdef PROSPECT_WITH_ZSTD
#include <zstd.h>
#endif

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/not_built_in.h"

namespace prospect {
namespace {

[[noreturn]] void not_decompressed(const std::string& where) {
  fail(where, "cannot be decompressed; expected an intact file");
}

#if defined(PROSPECT_WITH_LZ4) || defined(PROSPECT_WITH_ZSTD)
/// How many bytes a decoder took and wrote, and whether a frame has ended.
struct Step {
  std::size_t taken = 0, written = 0;
  bool frame_ended = false, good = false;
};
/// `decode(in, out)` is a step that takes bytes from `in` and writes some to the beginning of
/// `out`.
template <typename Decode>
void decode_frames(const Decode& decode, const ByteSource& source, const ByteSink& sink,
                   const std::string& where) {
  std::string out(std::size_t{1} << 17, '\0');
  bool ended = false;  // a frame, and no other has begun
  for (std::string_view in = source(); !in.empty(); in = source()) {
    while (true) {
      const Step step = decode(in, out);
      if (!step.good) not_decompressed(where);
      in.remove_prefix(step.taken);
      if (step.written > 0) sink(std::string_view(out).substr(0, step.written));
      const bool went_on = step.taken > 0 || step.written > 0;
      if (went_on) ended = step.frame_ended;
      if (in.empty() && step.written < out.size()) break;  // what fills `out` may not be all of it
      if (!in.empty() && !went_on) not_decompressed(where);
    }
  }
  if (!ended) not_decompressed(where);
}
#endif

void decompress_lz4(const ByteSource& source, const ByteSink& sink, const std::string& where) {
#ifdef PROSPECT_WITH_LZ4
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION))) not_decompressed(where);
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(
      made, &LZ4F_freeDecompressionContext);
  decode_frames(
      [&](std::string_view in, std::string& out) {
        Step step;
        step.taken = in.size();
        step.written = out.size();
        const std::size_t left = LZ4F_decompress(context.get(), out.data(), &step.written,
                                                 in.data(), &step.taken, nullptr);
        step.good = !LZ4F_isError(left);
        step.frame_ended = left == 0;
        return step;
      },
      source, sink, where);
#else
  static_cast<void>(source), static_cast<void>(sink);
  throw NotBuiltIn(where + ": reading what lz4 has compressed", "liblz4-dev");
#endif
}

void decompress_zstd(const ByteSource& source, const ByteSink& sink, const std::string& where) {
#ifdef PROSPECT_WITH_ZSTD
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                        &ZSTD_freeDCtx);
  if (context == nullptr) not_decompressed(where);
  decode_frames(
      [&](std::string_view from, std::string& to) {
        ZSTD_inBuffer in{from.data(), from.size(), 0};
        ZSTD_outBuffer out{to.data(), to.size(), 0};
        const std::size_t left = ZSTD_decompressStream(context.get(), &out, &in);
        return Step{in.pos, out.pos, left == 0, ZSTD_isError(left) == 0};
      },
      source, sink, where);
#else
  static_cast<void>(source), static_cast<void>(sink);
  throw NotBuiltIn(where + ": reading what zstd has compressed", "libzstd-dev");
#endif
}

}  // namespace

Compression compression_of(std::string_view bytes) {
  if (bytes.starts_with("\x28\xb5\x2f\xfd")) return Compression::kZstd;
  if (bytes.starts_with("\x04\x22\x4d\x18")) return Compression::kLz4;
  return Compression::kNone;
}

void decompress(Compression compression, const ByteSource& source, const ByteSink& sink,
                const std::string& where) {
  switch (compression) {
    case Compression::kNone:
      for (std::string_view in = source(); !in.empty(); in = source()) sink(in);
      return;
    case Compression::kLz4:
      return decompress_lz4(source, sink, where);
    case Compression::kZstd:
      return decompress_zstd(source, sink, where);
  }
}

std::string decompressed(Compression compression, std::string_view bytes, std::size_t most,
                         const std::string& where) {
  std::string out;
  decompress(
      compression, [&] { return std::exchange(bytes, {}); },
      [&](std::string_view piece) {
        if (piece.size() > most - out.size()) {
          fail(where,
               "becomes more than " + std::to_string(most) + " bytes; expected an intact file");
        }
        out += piece;
      },
      where);
  return out;
}

}  // namespace prospect
