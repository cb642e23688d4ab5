#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "apriltrack/bag/bag_reader.h"
#include "byte_buffer.h"

namespace apriltrack {

enum class Packing { kNone, kBz2, kLz4, kZstd };

/// "none" and "" are kNone; nullopt for what is not known.
std::optional<Packing> packing_of(std::string_view name);

/// What zstd packed begins so.
inline constexpr std::string_view kZstdMagic("\x28\xB5\x2F\xFD", 4);

/// Larger chunks and messages are not unpacked: usual chunks have 1 to 16 MB.
inline constexpr std::uint64_t kMostUnpackedBytes = std::uint64_t{1} << 30;

struct Unpacked {
  std::string error;    ///< Empty when all is well.
  bool is_cut = false;  ///< The error is that the packed bytes end too soon.
};

/// Unpacks streams that stand one behind the other (of bz2, LZ4 frames or zstd frames; not kNone), as writers
/// with several threads leave them. expected: how many bytes are said to come, a hint only: room grows as
/// they do come. What came before an error is in `into`. What follows and begins no stream is passed over.
Unpacked unpack(Packing packing, std::string_view packed, std::uint64_t expected, ByteBuffer& into);

/// A message of rosbag2 that was packed by itself (`--compression-mode message`); others are left as they
/// are. CDR begins with 0: what begins as zstd packs is no CDR yet.
void unpack_message(BagMessage& message, ByteBuffer& into);

}  // namespace apriltrack
