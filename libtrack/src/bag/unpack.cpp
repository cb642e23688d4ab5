#include "unpack.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <memory>

namespace apriltrack {
namespace {

/// Room for a claimed size is made up to so many times the packed size.
constexpr std::uint64_t kBelievedRatio = 32;
constexpr std::uint64_t kFirstRoom = 1 << 16;

Unpacked cut_off() {
  return {"its packed bytes end too soon", true};
}

/// Makes room for more; false where the limit is reached.
bool grow(ByteBuffer& into) {
  if (into.capacity() >= kMostUnpackedBytes) return false;
  into.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(2 * into.capacity(), kMostUnpackedBytes)));
  return true;
}

Unpacked too_large() {
  return {fmt::format("it unpacks to more than {} MiB, the most that is read", kMostUnpackedBytes >> 20)};
}

unsigned int clipped(std::size_t size) {
  return static_cast<unsigned int>(std::min<std::size_t>(size, std::numeric_limits<unsigned int>::max()));
}

// One stream each. What follows it stays in `packed`.

Unpacked unpack_bz2(std::string_view& packed, ByteBuffer& into) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return {"bz2 has no memory"};
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> closed(&stream, BZ2_bzDecompressEnd);
  stream.next_in = const_cast<char*>(packed.data());
  stream.avail_in = clipped(packed.size());
  for (;;) {
    if (into.size() == into.capacity() && !grow(into)) return too_large();
    stream.next_out = into.data() + into.size();
    stream.avail_out = clipped(into.capacity() - into.size());
    const unsigned int room = stream.avail_out;
    const int status = BZ2_bzDecompress(&stream);
    const std::size_t came = room - stream.avail_out;
    into.set_size(into.size() + came);
    if (status == BZ_STREAM_END) {
      packed.remove_prefix(packed.size() - stream.avail_in);
      return {};
    }
    if (status != BZ_OK) return {"its bz2 bytes are damaged"};
    if (stream.avail_in == 0 && came == 0) return cut_off();
  }
}

Unpacked unpack_lz4(std::string_view& packed, ByteBuffer& into) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION))) return {"lz4 has no memory"};
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(raw,
                                                                             LZ4F_freeDecompressionContext);
  for (;;) {
    if (into.size() == into.capacity() && !grow(into)) return too_large();
    std::size_t came = into.capacity() - into.size(), taken = packed.size();
    const std::size_t left =
        LZ4F_decompress(raw, into.data() + into.size(), &came, packed.data(), &taken, nullptr);
    if (LZ4F_isError(left)) return {fmt::format("its lz4 bytes are damaged ({})", LZ4F_getErrorName(left))};
    into.set_size(into.size() + came);
    packed.remove_prefix(taken);
    if (left == 0) return {};
    if (came == 0 && taken == 0) return cut_off();
  }
}

Unpacked unpack_zstd(std::string_view& packed, ByteBuffer& into) {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (!context) return {"zstd has no memory"};
  ZSTD_inBuffer input = {packed.data(), packed.size(), 0};
  for (;;) {
    if (into.size() == into.capacity() && !grow(into)) return too_large();
    ZSTD_outBuffer output = {into.data(), into.capacity(), into.size()};
    const std::size_t before = input.pos;
    const std::size_t left = ZSTD_decompressStream(context.get(), &output, &input);
    if (ZSTD_isError(left)) return {fmt::format("its zstd bytes are damaged ({})", ZSTD_getErrorName(left))};
    const bool is_stuck = output.pos == into.size() && input.pos == before;
    into.set_size(output.pos);
    if (left == 0) {
      packed.remove_prefix(input.pos);
      return {};
    }
    if (is_stuck) return cut_off();
  }
}

Unpacked unpack_stream(Packing packing, std::string_view& packed, ByteBuffer& into) {
  switch (packing) {
    case Packing::kBz2:
      return unpack_bz2(packed, into);
    case Packing::kLz4:
      return unpack_lz4(packed, into);
    case Packing::kZstd:
      return unpack_zstd(packed, into);
    case Packing::kNone:
      break;
  }
  return {"is not packed"};
}

/// Frames that hold bytes of their writer's, of LZ4 and zstd alike: 0x184D2A50 to 0x184D2A5F, little-endian.
bool begins_skippable_frame(std::string_view packed) {
  return packed.size() >= 4 && (packed[0] & 0xF0) == 0x50 && packed.substr(1, 3) == "\x2A\x4D\x18";
}

bool begins_stream(Packing packing, std::string_view packed) {
  switch (packing) {
    case Packing::kBz2:
      return packed.starts_with("BZh");
    case Packing::kLz4:
      return packed.starts_with("\x04\x22\x4D\x18") || begins_skippable_frame(packed);
    case Packing::kZstd:
      return packed.starts_with(kZstdMagic) || begins_skippable_frame(packed);
    case Packing::kNone:
      break;
  }
  return false;
}

}  // namespace

std::optional<Packing> packing_of(std::string_view name) {
  if (name.empty() || name == "none") return Packing::kNone;
  if (name == "bz2") return Packing::kBz2;
  if (name == "lz4") return Packing::kLz4;
  if (name == "zstd") return Packing::kZstd;
  return std::nullopt;
}

Unpacked unpack(Packing packing, std::string_view packed, std::uint64_t expected, ByteBuffer& into) {
  into.set_size(0);
  // A byte more than expected, so that the end of the stream is seen without growing.
  const std::uint64_t believed = std::min(expected, kBelievedRatio * packed.size()) + 1;
  into.reserve(static_cast<std::size_t>(std::clamp(believed, kFirstRoom, kMostUnpackedBytes)));
  Unpacked result;
  do result = unpack_stream(packing, packed, into);
  while (result.error.empty() && begins_stream(packing, packed));
  return result;
}

void unpack_message(BagMessage& message, ByteBuffer& into) {
  if (!message.bytes.starts_with(kZstdMagic)) return;
  const Unpacked result = unpack(Packing::kZstd, message.bytes, 8 * message.bytes.size(), into);
  message.bytes = result.error.empty() ? into.view() : std::string_view();
  message.error = result.error;
}

}  // namespace apriltrack
