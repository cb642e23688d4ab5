#include "pack.h"

#include <lz4frame.h>
#include <zstd.h>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

std::string pack_lz4(std::string_view bytes) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.contentSize = bytes.size();
  std::string packed(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  const std::size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
  APRILTRACK_CHECK(LZ4F_isError(size) == 0, "lz4 packs what has room");
  packed.resize(size);
  return packed;
}

std::string pack_zstd(std::string_view bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  APRILTRACK_CHECK(ZSTD_isError(size) == 0, "zstd packs what has room");
  packed.resize(size);
  return packed;
}

}  // namespace

std::string_view name_of(ChunkPacking packing) {
  switch (packing) {
    case ChunkPacking::kLz4:
      return "lz4";
    case ChunkPacking::kZstd:
      return "zstd";
    case ChunkPacking::kNone:
      break;
  }
  return "";
}

std::string pack(ChunkPacking packing, std::string_view bytes) {
  switch (packing) {
    case ChunkPacking::kLz4:
      return pack_lz4(bytes);
    case ChunkPacking::kZstd:
      return pack_zstd(bytes);
    case ChunkPacking::kNone:
      break;
  }
  return std::string(bytes);
}

}  // namespace apriltrack
