#include "png_picture.h"

#include <cstdint>
#include <string_view>

#include "apriltrack/io/byte_order.h"
#include "apriltrack/io/crc32.h"

namespace apriltrack {
namespace {

/// RFC 1950.
std::uint32_t adler32_of(std::string_view bytes) {
  std::uint32_t a = 1, b = 0;
  for (const char c : bytes) {
    a = (a + static_cast<unsigned char>(c)) % 65521u;
    b = (b + a) % 65521u;
  }
  return (b << 16) | a;
}

std::string png_chunk(std::string_view type, const std::string& data) {
  const std::string body = std::string(type) + data;
  std::string chunk;
  append_big_endian(chunk, data.size(), 4);
  chunk += body;
  append_big_endian(chunk, crc32(body), 4);
  return chunk;
}

/// One stored block (RFC 1951) in a zlib stream: up to 65535 bytes, and a tag's picture has some hundred.
std::string zlib_stored(const std::string& bytes) {
  std::string out = {'\x78', '\x01', '\x01'};
  append_little_endian(out, bytes.size(), 2);
  append_little_endian(out, ~bytes.size(), 2);
  out += bytes;
  append_big_endian(out, adler32_of(bytes), 4);
  return out;
}

}  // namespace

std::string png_of_cells(const Image<float>& cells) {
  std::string rows;
  for (int y = 0; y < cells.height(); ++y) {
    rows += '\0';  // no filter
    for (int x = 0; x < cells.width(); ++x) rows += cells(x, y) < 0.5f ? '\x00' : '\xFF';
  }
  std::string header;
  append_big_endian(header, static_cast<std::uint64_t>(cells.width()), 4);
  append_big_endian(header, static_cast<std::uint64_t>(cells.height()), 4);
  header += std::string("\x08\x00\x00\x00\x00", 5);
  return std::string("\x89PNG\r\n\x1A\n", 8) + png_chunk("IHDR", header) +
         png_chunk("IDAT", zlib_stored(rows)) + png_chunk("IEND", "");
}

}  // namespace apriltrack
