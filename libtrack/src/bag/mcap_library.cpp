#include "apriltrack/bag/mcap_writer.h"
#include "apriltrack/base/error.h"
#include "mcap_data.h"
#include "mcap_records.h"
#include "random_access_file.h"

namespace apriltrack {

std::optional<std::string> mcap_library(const std::filesystem::path& path) {
  constexpr std::uint64_t kEnough = 4096;  // two short words
  try {
    const std::string start = RandomAccessFile(path).read(0, kEnough);
    if (!start.starts_with(kMcapMagic)) return std::nullopt;
    ByteCursor cursor(start, kMcapMagic.size());
    const McapRecord header = take_mcap_record(cursor);
    if (header.op != McapOp::kHeader) return std::nullopt;
    ByteCursor fields(header.content);
    fields.sized();  // the profile
    return std::string(fields.sized());
  } catch (const BadBytes&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace apriltrack
