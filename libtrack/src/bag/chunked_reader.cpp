#include "chunked_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/io/crc32.h"
#include "byte_cursor.h"

namespace apriltrack {
namespace {

constexpr std::size_t kNothing = std::numeric_limits<std::size_t>::max();

class ChunkedReader : public BagReader {
 public:
  ChunkedReader(std::shared_ptr<const RandomAccessFile> file, std::unique_ptr<ChunkedFormat> format)
      : file_(std::move(file)), format_(std::move(format)), layout_(format_->lay_out(damage_)) {
    for (const MessagePlace& place : layout_.single_messages) found_.push_back(place);
    for (std::size_t chunk = 0; chunk < layout_.chunks.size(); ++chunk)
      if (!layout_.chunks[chunk].has_index || has_unknown_channel(layout_.chunks[chunk]))
        find_messages(chunk);
    drop_unknown_channels();
    list_topics();
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }

  void choose(const std::set<std::size_t>& topics) override {
    chosen_.clear();
    loaded_ = kNothing;
    for (const auto& [channel, topic] : topic_of_channel_)
      if (topics.contains(topic)) chosen_.insert(channel);
    list_places();
    position_ = 0;
  }

  std::size_t num_messages() const override { return places_.size(); }

  std::optional<Timestamp> next_time() override {
    if (position_ >= places_.size()) return std::nullopt;
    return Timestamp{places_[position_].time_ns};
  }

  bool pass_over() override {
    if (position_ >= places_.size()) return false;
    ++position_;
    return true;
  }

  std::optional<BagMessage> next() override {
    while (position_ < places_.size()) {
      const MessagePlace place = places_[position_];
      const std::string error = load(place.chunk);
      BagMessage message{topic_of_channel_.at(place.channel), {place.time_ns}, {}, error};
      if (error.empty()) {
        const FoundMessage* const found = contents_of(place);
        if (!found) {
          distrust_indices();
          continue;
        }
        message.bytes = found->data;
        if (topics_[message.topic].encoding == "cdr") unpack_message(message, message_);
        if (!message.error.empty()) damage_.lost_message(layout_.chunks[place.chunk].offset, message.error);
      }
      ++position_;
      return message;
    }
    return std::nullopt;
  }

  std::string damage() const override { return damage_.summary(); }

 private:
  bool has_unknown_channel(const Chunk& chunk) const {
    return std::ranges::any_of(chunk.index, [&](const IndexPlace& place) {
      return place.count > 0 && !layout_.channels.contains(place.channel);
    });
  }

  std::vector<std::uint32_t> hints_of(const Chunk& chunk) const {
    std::vector<std::uint32_t> hints;
    for (const IndexPlace& place : chunk.index) {
      try {
        for (const MessagePlace& entry : format_->read_index(place)) hints.push_back(entry.offset);
      } catch (const BadBytes&) {
        continue;  // a hint less
      }
    }
    std::ranges::sort(hints);
    return hints;
  }

  /// Reads a chunk without its index.
  void find_messages(std::size_t index) {
    layout_.chunks[index].has_index = false;
    if (!load(index).empty()) return;
    for (const auto& [id, channel] : contents_.channels) {
      BagChannel& known = layout_.channels.try_emplace(id, channel).first->second;
      if (known.type.empty()) known = channel;  // its schema came later
    }
    for (const FoundMessage& message : contents_.messages)
      found_.push_back({message.time_ns, static_cast<std::uint32_t>(index), message.channel, message.offset});
  }

  void drop_unknown_channels() {
    std::erase_if(found_, [&](const MessagePlace& place) {
      if (layout_.channels.contains(place.channel)) return false;
      damage_.lost_message(layout_.chunks[place.chunk].offset, "no record tells of its topic");
      return true;
    });
  }

  void list_topics() {
    std::map<std::uint32_t, std::size_t> count;
    for (const MessagePlace& place : found_) ++count[place.channel];
    for (const Chunk& chunk : layout_.chunks) {
      if (!chunk.has_index) continue;
      for (const IndexPlace& place : chunk.index) count[place.channel] += place.count;
    }
    std::map<std::tuple<std::string, std::string, std::string>, std::size_t> known;
    for (const auto& [id, channel] : layout_.channels) {
      const auto [topic, is_new] =
          known.insert({{channel.topic, channel.type, channel.encoding}, topics_.size()});
      if (is_new)
        topics_.push_back({channel.topic, channel.type, channel.encoding, channel.schema_encoding, 0});
      topics_[topic->second].count += count[id];
      topic_of_channel_[id] = topic->second;
    }
  }

  void list_places() {
    places_.clear();
    num_expected_.assign(layout_.chunks.size(), 0);
    const auto add = [&](MessagePlace place) {
      ++num_expected_[place.chunk];
      places_.push_back(place);
    };
    for (std::size_t index = 0; index < layout_.chunks.size(); ++index)
      for (const MessagePlace& place : chosen_by_index(index)) add(place);
    for (const MessagePlace& place : found_)
      if (chosen_.contains(place.channel)) add(place);
    std::ranges::sort(places_, {}, [](const MessagePlace& place) {
      return std::tuple(place.time_ns, place.chunk, place.offset);
    });
  }

  std::vector<MessagePlace> chosen_by_index(std::size_t index) {
    const Chunk& chunk = layout_.chunks[index];
    std::vector<MessagePlace> places;
    if (!chunk.has_index) return places;
    try {
      for (const IndexPlace& of_channel : chunk.index) {
        if (!chosen_.contains(of_channel.channel)) continue;
        for (MessagePlace& place : format_->read_index(of_channel)) {
          place.chunk = static_cast<std::uint32_t>(index);
          places.push_back(place);
        }
      }
    } catch (const BadBytes&) {
      damage_.has_no_index();
      find_messages(index);
      return {};
    }
    return places;
  }

  /// Brings a chunk into memory, with its messages in the order of their offsets. Returns why that cannot be.
  std::string load(std::size_t index) {
    if (loaded_ == index) return load_error_;
    loaded_ = index;
    const Chunk& chunk = layout_.chunks[index];
    contents_ = {};
    const std::string fault = unpack_chunk(chunk);
    load_error_ =
        fault.empty() ? "" : fmt::format("its chunk, at byte {}, cannot be read: {}", chunk.offset, fault);
    if (!fault.empty()) {
      if (lost_.insert(index).second) damage_.lost_chunk(chunk.offset, fault);
      return load_error_;
    }
    contents_ = format_->walk(content_, {});
    if (!contents_.damage.empty()) {
      contents_ = format_->walk(content_, hints_of(chunk));
      if (hurt_.insert(index).second) damage_.hurt_chunk(chunk.offset, contents_.damage);
    }
    num_chosen_loaded_ = static_cast<std::size_t>(std::ranges::count_if(
        contents_.messages, [&](const FoundMessage& message) { return chosen_.contains(message.channel); }));
    return "";
  }

  std::string unpack_chunk(const Chunk& chunk) {
    const std::uint64_t size =
        std::min(chunk.data_size, file_->size() - std::min(file_->size(), chunk.data_offset));
    if (size > kMostUnpackedBytes) return fmt::format("it has {} bytes, more than are read at once", size);
    if (!chunk.packing) return fmt::format("it is packed by '{}', which is not read", chunk.packing_name);
    file_->read(chunk.data_offset, size, packed_);
    content_ = packed_.view();
    if (content_.size() < chunk.data_size && !chunk.is_partial) return "the file ends before it";
    if (chunk.packing != Packing::kNone) {
      const Unpacked result = unpack(*chunk.packing, packed_.view(), chunk.unpacked_size, unpacked_);
      content_ = unpacked_.view();
      // Checksums stand at the end of a block or a stream: what came before damage may be wrong, before a cut
      // not.
      const bool is_usable = chunk.is_partial && result.is_cut;
      if (!result.error.empty() && !(is_usable && !content_.empty())) return result.error;
      if (!result.error.empty() && hurt_.insert(loaded_).second)
        damage_.hurt_chunk(chunk.offset, result.error);
    }
    return chunk.is_partial ? "" : check_content(chunk);
  }

  /// Of a size that is not as told, the header may be wrong or the content: the CRC decides. Without one,
  /// what is there is given, as of a chunk that is damaged.
  std::string check_content(const Chunk& chunk) {
    const bool has_size = content_.size() == chunk.unpacked_size;
    const std::string wrong_size = has_size ? ""
                                            : fmt::format("it has {} bytes, and its header says {}",
                                                          content_.size(), chunk.unpacked_size);
    if (chunk.crc != 0 && crc32(content_) != chunk.crc)
      return has_size ? "its CRC-32 is not that of its content"
                      : wrong_size + ", nor is its CRC-32 that of its content";
    if (has_size || !hurt_.insert(loaded_).second) return "";
    if (chunk.crc != 0)
      damage_.wrong_header(chunk.offset, wrong_size);
    else
      damage_.hurt_chunk(chunk.offset, wrong_size);
    return "";
  }

  /// The message that the index promises; nullptr where the chunk that is loaded holds others.
  const FoundMessage* contents_of(const MessagePlace& place) const {
    const auto& messages = contents_.messages;
    if (num_chosen_loaded_ != num_expected_[place.chunk]) return nullptr;
    const auto found = std::ranges::lower_bound(messages, place.offset, {}, &FoundMessage::offset);
    const bool is_it = found != messages.end() && found->offset == place.offset &&
                       found->channel == place.channel && found->time_ns == place.time_ns;
    return is_it ? &*found : nullptr;
  }

  /// The index of a chunk is not as the chunk: all chunks are looked into, and what was given already is left
  /// out.
  void distrust_indices() {
    damage_.has_no_index();
    std::vector<MessagePlace> given(places_.begin(),
                                    places_.begin() + static_cast<std::ptrdiff_t>(position_));
    const auto by_place = [](const MessagePlace& a, const MessagePlace& b) {
      return std::tie(a.chunk, a.offset) < std::tie(b.chunk, b.offset);
    };
    std::ranges::sort(given, by_place);
    found_.clear();
    for (std::size_t index = 0; index < layout_.chunks.size(); ++index) find_messages(index);
    drop_unknown_channels();
    list_places();
    std::erase_if(places_, [&](const MessagePlace& place) {
      return std::binary_search(given.begin(), given.end(), place, by_place);
    });
    position_ = 0;
  }

  std::shared_ptr<const RandomAccessFile> file_;
  std::unique_ptr<ChunkedFormat> format_;
  Damage damage_;
  FileLayout layout_;
  std::vector<MessagePlace> found_;  ///< Of chunks without an index.
  std::vector<BagTopic> topics_;
  std::map<std::uint32_t, std::size_t> topic_of_channel_;

  std::set<std::uint32_t> chosen_;
  std::vector<MessagePlace> places_;       ///< Of the channels chosen, in the order of time.
  std::vector<std::size_t> num_expected_;  ///< Of the channels chosen, by chunk.
  std::size_t position_ = 0;

  std::size_t loaded_ = kNothing;
  std::string load_error_;
  ByteBuffer packed_, unpacked_, message_;
  std::string_view content_;
  ChunkContents contents_;
  std::size_t num_chosen_loaded_ = 0;
  std::set<std::size_t> hurt_, lost_;  ///< Told already.
};

}  // namespace

std::unique_ptr<BagReader> chunked_reader(std::shared_ptr<const RandomAccessFile> file,
                                          std::unique_ptr<ChunkedFormat> format) {
  return std::make_unique<ChunkedReader>(std::move(file), std::move(format));
}

}  // namespace apriltrack
