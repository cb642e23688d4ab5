#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "damage.h"
#include "unpack.h"

namespace apriltrack {

/// What writes one kind of messages to one topic: a connection of ROS 1, a channel of MCAP.
struct BagChannel {
  std::string topic;
  std::string type;
  std::string encoding;
  std::string schema_encoding;
};

/// Where the index of one channel's messages in one chunk is.
struct IndexPlace {
  std::uint32_t channel = 0;
  std::uint64_t offset = 0;  ///< Of its entries, in the file.
  std::uint32_t count = 0;
};

/// One message, by the index or as found.
struct MessagePlace {
  std::int64_t time_ns = 0;
  std::uint32_t chunk = 0;
  std::uint32_t channel = 0;
  std::uint32_t offset = 0;  ///< Of its record in the unpacked chunk.

  bool operator==(const MessagePlace&) const = default;
};

/// A run of records that is read at once. A message that lies in no chunk of the file is one of its own, and
/// its index.
struct Chunk {
  std::uint64_t offset = 0;       ///< Of its record in the file.
  std::uint64_t data_offset = 0;  ///< Of its bytes in the file, as packed.
  std::uint64_t data_size = 0;
  std::uint64_t unpacked_size = 0;                  ///< As its header says.
  std::optional<Packing> packing = Packing::kNone;  ///< None: in a way that is not read.
  std::string packing_name = {};                    ///< As its header says.
  std::uint32_t crc = 0;                            ///< Of the unpacked bytes; 0: none is told.
  std::vector<IndexPlace> index = {};
  bool has_index = false;   ///< `index` tells of all its messages, as far as can be seen from outside.
  bool is_partial = false;  ///< The file ends within it, or its size is in doubt: the CRC cannot be right.
};

struct FileLayout {
  std::map<std::uint32_t, BagChannel> channels;
  std::vector<Chunk> chunks;
  std::vector<MessagePlace> single_messages;  ///< Those that are chunks of their own.

  void add_single_message(std::uint64_t offset, std::uint64_t size, std::uint32_t channel,
                          std::int64_t time_ns);
};

inline void FileLayout::add_single_message(std::uint64_t offset, std::uint64_t size, std::uint32_t channel,
                                           std::int64_t time_ns) {
  single_messages.push_back({time_ns, static_cast<std::uint32_t>(chunks.size()), channel, 0});
  chunks.push_back(
      {.offset = offset, .data_offset = offset, .data_size = size, .unpacked_size = size, .has_index = true});
}

/// A record with a message in an unpacked chunk.
struct FoundMessage {
  std::uint32_t channel = 0;
  std::int64_t time_ns = 0;
  std::uint32_t offset = 0;
  std::string_view data;
};

/// What the walk through an unpacked chunk gives.
struct ChunkContents {
  std::vector<FoundMessage> messages;
  std::map<std::uint32_t, BagChannel> channels;
  std::string damage;  ///< Why not all of it could be read; empty when it could.
};

/// A file format whose messages lie in chunks.
class ChunkedFormat {
 public:
  virtual ~ChunkedFormat() = default;

  /// Finds the chunks, and channels as far as they are told outside of chunks.
  virtual FileLayout lay_out(Damage& damage) = 0;
  /// hints: where the index says that records begin, in order; beyond a damaged record it goes on there.
  virtual ChunkContents walk(std::string_view unpacked, const std::vector<std::uint32_t>& hints) = 0;
  /// The messages of one channel of a chunk, by the index; `chunk` is left 0. Throws BadBytes.
  virtual std::vector<MessagePlace> read_index(const IndexPlace& place) const = 0;
};

}  // namespace apriltrack
