#include "tiff_directory.h"

#include <cstddef>

#include "apriltrack/io/byte_order.h"

namespace apriltrack {
namespace {

/// Numbers of a TIFF file in its own byte order; 0 beyond its end.
class TiffBytes {
 public:
  explicit TiffBytes(std::string_view bytes) : bytes_(bytes), is_big_endian_(bytes.starts_with("MM")) {}

  bool is_tiff() const {
    constexpr std::int64_t kMagic = 42;
    return (is_big_endian_ || bytes_.starts_with("II")) && number(2, 2) == kMagic;
  }
  std::int64_t number(std::size_t at, std::size_t count) const {
    if (at > bytes_.size() || count > bytes_.size() - at) return 0;
    const std::string_view taken = bytes_.substr(at, count);
    return static_cast<std::int64_t>(is_big_endian_ ? big_endian(taken) : little_endian(taken));
  }

 private:
  std::string_view bytes_;
  bool is_big_endian_;
};

}  // namespace

std::optional<std::int64_t> tiff_value(std::string_view tiff, std::uint16_t tag) {
  constexpr std::size_t kEntry = 12;
  constexpr std::int64_t kShort = 3, kLong = 4;
  const TiffBytes bytes(tiff);
  if (!bytes.is_tiff()) return std::nullopt;
  const auto directory = static_cast<std::size_t>(bytes.number(4, 4));
  const auto num_entries = static_cast<std::size_t>(bytes.number(directory, 2));
  for (std::size_t i = 0; i < num_entries; ++i) {
    const std::size_t at = directory + 2 + kEntry * i;
    if (at + kEntry > tiff.size()) break;
    if (bytes.number(at, 2) != tag) continue;
    const std::int64_t type = bytes.number(at + 2, 2);
    if (bytes.number(at + 4, 4) != 1 || (type != kShort && type != kLong)) return std::nullopt;
    return bytes.number(at + 8, type == kShort ? 2 : 4);
  }
  return std::nullopt;
}

}  // namespace apriltrack
