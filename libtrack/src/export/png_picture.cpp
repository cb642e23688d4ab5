#include "png_picture.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace apriltrack {
namespace {

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>((value >> shift) & 0xFFu);
  return bytes;
}

/// ISO 3309, as PNG's annex D has it.
std::uint32_t crc32_of(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

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
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(crc32_of(body));
}

/// One stored block (RFC 1951) in a zlib stream: up to 65535 bytes, and a tag's picture has some hundred.
std::string zlib_stored(const std::string& bytes) {
  const auto size = static_cast<std::uint16_t>(bytes.size());
  std::string out = {'\x78', '\x01', '\x01'};
  for (const std::uint16_t number : {size, static_cast<std::uint16_t>(~size)}) {
    out += static_cast<char>(number & 0xFFu);
    out += static_cast<char>(number >> 8);
  }
  return out + bytes + big_endian(adler32_of(bytes));
}

}  // namespace

std::string png_of_cells(const Image<float>& cells) {
  std::string rows;
  for (int y = 0; y < cells.height(); ++y) {
    rows += '\0';  // no filter
    for (int x = 0; x < cells.width(); ++x) rows += cells(x, y) < 0.5f ? '\x00' : '\xFF';
  }
  const std::string header = big_endian(static_cast<std::uint32_t>(cells.width())) +
                             big_endian(static_cast<std::uint32_t>(cells.height())) +
                             std::string("\x08\x00\x00\x00\x00", 5);
  return std::string("\x89PNG\r\n\x1A\n", 8) + png_chunk("IHDR", header) +
         png_chunk("IDAT", zlib_stored(rows)) + png_chunk("IEND", "");
}

std::string base64(const std::string& bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = (group << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kAlphabet[(group >> (18 - 6 * k)) & 63u] : '=';
  }
  return out;
}

}  // namespace apriltrack
