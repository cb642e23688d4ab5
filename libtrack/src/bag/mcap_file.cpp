#include "mcap_file.h"

#include <fmt/format.h>

#include <utility>

#include "apriltrack/base/error.h"
#include "mcap_data.h"
#include "mcap_scan.h"
#include "mcap_summary.h"

namespace apriltrack {
namespace {

class McapFile : public ChunkedFormat {
 public:
  explicit McapFile(std::shared_ptr<const RandomAccessFile> file) : file_(std::move(file)) {
    check_version();
  }

  FileLayout lay_out(Damage& damage) override {
    McapSummary summary = read_mcap_summary(*file_, channels_, damage);
    if (summary.layout) return std::move(*summary.layout);
    if (!summary.is_closed) damage.has_no_index();
    return scan_mcap(*file_, channels_, damage);
  }

  ChunkContents walk(std::string_view unpacked, const std::vector<std::uint32_t>& hints) override {
    return walk_mcap(unpacked, hints, channels_);
  }

  std::vector<MessagePlace> read_index(const IndexPlace& place) const override {
    const std::string bytes = file_->read(place.offset, kMcapIndexEntryBytes * place.count);
    ByteCursor cursor(bytes);
    std::vector<MessagePlace> entries;
    for (std::uint32_t i = 0; i < place.count; ++i) {
      const auto time_ns = static_cast<std::int64_t>(cursor.u64());
      const std::uint64_t offset = cursor.u64();
      if (offset > kMostUnpackedBytes) throw BadBytes("an index is damaged");
      entries.push_back({time_ns, 0, place.channel, static_cast<std::uint32_t>(offset)});
    }
    return entries;
  }

 private:
  void check_version() const {
    const std::string start = file_->read(0, kMcapMagic.size());
    if (start == kMcapMagic) return;
    if (start.size() == kMcapMagic.size() && start.substr(6) == kMcapMagic.substr(6))
      throw invalid_input(
          file_->name(),
          fmt::format("is an MCAP file of major version '{}'; only version '0' is read", start[5]));
    throw io_error(file_->name(), "begins like an MCAP file, but its first 8 bytes are damaged");
  }

  std::shared_ptr<const RandomAccessFile> file_;
  McapChannels channels_;  ///< Of all that was read so far.
};

}  // namespace

std::unique_ptr<ChunkedFormat> mcap_file(std::shared_ptr<const RandomAccessFile> file) {
  return std::make_unique<McapFile>(std::move(file));
}

}  // namespace apriltrack
