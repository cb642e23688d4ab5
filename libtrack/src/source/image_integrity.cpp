#include "image_integrity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "apriltrack/io/byte_order.h"
#include "apriltrack/io/crc32.h"
#include "tiff_directory.h"

namespace apriltrack {
namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegSignature = "\xff\xd8\xff";
constexpr const char* kCut = "the file is cut short";
constexpr const char* kBroken = "the data is damaged";

std::uint8_t byte_at(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint8_t>(bytes[at]);
}

std::uint32_t big_endian_at(std::string_view bytes, std::size_t at, std::size_t count) {
  return static_cast<std::uint32_t>(big_endian(bytes.substr(at, count)));
}

std::uint32_t little_endian_32(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint32_t>(little_endian(bytes.substr(at, 4)));
}

struct PngChunk {
  std::string_view type;
  std::string_view data;
  std::string_view whole;  ///< With length, type and sum.
};

/// The chunk that begins at a byte (PNG specification, section 5.3); nullopt where the file ends before it
/// does.
std::optional<PngChunk> png_chunk_at(std::string_view bytes, std::size_t at) {
  constexpr std::size_t kFrame = 12;  // length, type and sum round each chunk's data
  if (at > bytes.size() || bytes.size() - at < kFrame) return std::nullopt;
  const std::size_t length = big_endian_at(bytes, at, 4);
  if (length > bytes.size() - at - kFrame) return std::nullopt;
  return PngChunk{bytes.substr(at + 4, 4), bytes.substr(at + 8, length), bytes.substr(at, length + kFrame)};
}

/// Upper case begins the types of chunks that a picture cannot do without; eXIf tells how to turn it.
bool matters_to_pixels(const PngChunk& chunk) {
  return (byte_at(chunk.type, 0) & 0x20) == 0 || chunk.type == "eXIf";
}

bool has_right_sum(const PngChunk& chunk) {
  const std::string_view summed = chunk.whole.substr(4, chunk.whole.size() - 8);
  return crc32(summed) == big_endian_at(chunk.whole, chunk.whole.size() - 4, 4);
}

/// Chunk by chunk to IEND. Sums are looked at here, for libpng tells of wrong ones on stderr.
ImageIntegrity inspect_png(std::string_view bytes) {
  ImageIntegrity found{.kind = ImageKind::kPng};
  for (std::size_t at = kPngSignature.size();;) {
    const auto chunk = png_chunk_at(bytes, at);
    if (!chunk) break;
    if (chunk->type == "IHDR" && chunk->data.size() >= 9) {
      found.size = {big_endian_at(chunk->data, 0, 4), big_endian_at(chunk->data, 4, 4)};
      found.bits_per_sample = byte_at(chunk->data, 8);
    }
    if (matters_to_pixels(*chunk) && !has_right_sum(*chunk)) {
      found.damage = fmt::format("{}: the sum of a chunk of this PNG is wrong, at byte {}", kBroken, at);
      return found;
    }
    if (chunk->type == "IEND") return found;
    at += chunk->whole.size();
  }
  found.damage = fmt::format("{}: a PNG without its IEND chunk", kCut);
  return found;
}

/// Markers of ITU-T T.81, annex B.
namespace jpeg {
constexpr std::uint8_t kEndOfImage = 0xD9;
constexpr std::uint8_t kStartOfScan = 0xDA;
constexpr std::uint8_t kNumberOfLines = 0xDC;
constexpr std::uint8_t kTemporary = 0x01;
bool is_restart(std::uint8_t marker) {
  return marker >= 0xD0 && marker <= 0xD7;
}
bool is_start_of_frame(std::uint8_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}
bool is_baseline(std::uint8_t marker) {
  return marker == 0xC0 || marker == 0xC1;
}
}  // namespace jpeg

/// Walks the segments, not just the file's last bytes: thumbnails hold end markers too, and cameras append to
/// files.
class JpegWalk {
 public:
  explicit JpegWalk(std::string_view bytes) : bytes_(bytes) {}

  ImageIntegrity run() {
    while (found_.damage.empty() && !is_at_end_) step();
    if (found_.damage.empty() && !has_scan_)
      found_.damage = fmt::format("{}: a JPEG without a picture", kBroken);
    return found_;
  }

 private:
  void cut() { found_.damage = fmt::format("{}: a JPEG without its end marker", kCut); }
  void broken() { found_.damage = fmt::format("{}: a JPEG marker stands where none may", kBroken); }

  void step() {
    const auto marker = read_marker();
    if (!marker) return;
    // A picture whose colours come in one scan is over with it; anything else there is a scan that broke off.
    const bool may_follow = !is_complete_ || *marker == jpeg::kEndOfImage || *marker == jpeg::kNumberOfLines;
    if (!may_follow || *marker == 0x00 || jpeg::is_restart(*marker)) return broken();
    if (*marker == jpeg::kEndOfImage) {
      is_at_end_ = true;
    } else if (*marker != jpeg::kTemporary) {
      read_segment(*marker);
    }
  }

  std::optional<std::uint8_t> read_marker() {
    if (at_ < bytes_.size() && byte_at(bytes_, at_) != 0xFF) {
      broken();
      return std::nullopt;
    }
    while (at_ < bytes_.size() && byte_at(bytes_, at_) == 0xFF) ++at_;  // fill bytes may precede a marker
    if (at_ >= bytes_.size()) {
      cut();
      return std::nullopt;
    }
    return byte_at(bytes_, at_++);
  }

  void read_segment(std::uint8_t marker) {
    if (at_ + 2 > bytes_.size()) return cut();
    const std::size_t length = big_endian_at(bytes_, at_, 2);
    if (length < 2) return broken();
    if (length > bytes_.size() - at_) return cut();
    if (jpeg::is_start_of_frame(marker) && length >= 8) {
      found_.size = {big_endian_at(bytes_, at_ + 5, 2), big_endian_at(bytes_, at_ + 3, 2)};
      num_components_ = byte_at(bytes_, at_ + 7);
      is_baseline_ = jpeg::is_baseline(marker);
    }
    if (marker == jpeg::kStartOfScan) {
      has_scan_ = true;
      is_complete_ = is_baseline_ && length >= 3 && byte_at(bytes_, at_ + 2) == num_components_;
    }
    at_ += length;
    if (marker == jpeg::kStartOfScan) pass_over_coded_data();
  }

  /// To the next marker that is neither a stuffed zero nor a restart.
  void pass_over_coded_data() {
    for (; at_ + 1 < bytes_.size(); ++at_) {
      if (byte_at(bytes_, at_) != 0xFF) continue;
      const std::uint8_t next = byte_at(bytes_, at_ + 1);
      if (next != 0x00 && next != 0xFF && !jpeg::is_restart(next)) return;
    }
    cut();
  }

  std::string_view bytes_;
  std::size_t at_ = 2;
  ImageIntegrity found_{.kind = ImageKind::kJpeg};
  int num_components_ = 0;
  bool is_baseline_ = false;
  bool has_scan_ = false;
  bool is_complete_ = false;
  bool is_at_end_ = false;
};

/// A number of a PNM header; comments run to the end of their line.
std::optional<std::int64_t> read_pnm_number(std::string_view bytes, std::size_t& at) {
  constexpr std::size_t kMaxDigits = 10;
  while (at < bytes.size() && (std::isspace(byte_at(bytes, at)) || bytes[at] == '#')) {
    if (bytes[at] == '#') at = std::min(bytes.find('\n', at), bytes.size() - 1);
    ++at;
  }
  std::int64_t value = 0;
  const std::size_t start = at;
  for (; at < bytes.size() && std::isdigit(byte_at(bytes, at)) && at - start < kMaxDigits; ++at)
    value = 10 * value + (bytes[at] - '0');
  if (at == start) return std::nullopt;
  return value;
}

/// Grey and colour, binary (P5, P6) or in digits (P2, P3).
ImageIntegrity inspect_pnm(std::string_view bytes) {
  ImageIntegrity found{.kind = ImageKind::kPnm};
  std::size_t at = 2;
  const auto width = read_pnm_number(bytes, at);
  const auto height = read_pnm_number(bytes, at);
  const auto largest = read_pnm_number(bytes, at);
  if (!width || !height || !largest) {
    found.damage = fmt::format("{}: its header lacks width, height or largest value", kBroken);
    return found;
  }
  constexpr std::int64_t kMaxScale = 65535;
  if (*largest < 1 || *largest > kMaxScale) {
    found.damage =
        fmt::format("{}: the largest value must lie in [1, {}] (is {})", kBroken, kMaxScale, *largest);
    return found;
  }
  found.size = {*width, *height};
  const bool is_binary = bytes[1] == '5' || bytes[1] == '6';
  constexpr std::int64_t kMaxByte = 255;
  const bool is_scaled_by_decoder = !is_binary && *largest <= kMaxByte;  // OpenCV 4 does so for digits alone
  if (!is_scaled_by_decoder) found.full_scale = static_cast<int>(*largest);
  if (!is_binary) return found;
  const double bytes_per_pixel = (bytes[1] == '6' ? 3.0 : 1.0) * (*largest > 255 ? 2.0 : 1.0);
  const double needed = bytes_per_pixel * static_cast<double>(*width) * static_cast<double>(*height);
  const double present = static_cast<double>(bytes.size()) - static_cast<double>(at) - 1.0;
  if (present < needed)
    found.damage = fmt::format("{}: {:.0f} bytes of {:.0f}", kCut, std::max(present, 0.0), needed);
  return found;
}

/// Where the pixels of a bitmap end that is not packed, or its palette, if there is one and that is later. Of
/// any numbers that the file holds, within those sizes that are read.
double end_of_bitmap(std::string_view bytes, const ClaimedSize& size) {
  constexpr std::uint32_t kRle8 = 1, kRle4 = 2;
  const std::uint32_t header = little_endian_32(bytes, 14), bits = little_endian_32(bytes, 28) & 0xFFFF;
  const std::uint32_t packing = little_endian_32(bytes, 30), colours = little_endian_32(bytes, 46);
  const double num_colours = bits > 8 ? 0.0 : colours > 0 ? colours : static_cast<double>(1U << bits);
  const double palette_end = 14.0 + header + 4.0 * num_colours;
  if (packing == kRle8 || packing == kRle4) return palette_end;
  const double row = 4.0 * std::ceil(static_cast<double>(size.width) * bits / 32.0);
  return std::max(palette_end, little_endian_32(bytes, 10) + row * static_cast<double>(size.height));
}

/// The header that Windows writes, or the older, shorter one, with 16 bits for each side.
ImageIntegrity inspect_bmp(std::string_view bytes) {
  constexpr std::size_t kHeader = 26;
  constexpr std::uint32_t kOldHeader = 12;
  ImageIntegrity found{.kind = ImageKind::kBmp};
  if (bytes.size() < kHeader || little_endian_32(bytes, 2) > bytes.size()) {
    found.damage = fmt::format("{}: shorter than its own header says", kCut);
    return found;
  }
  const std::uint32_t first = little_endian_32(bytes, 18);
  if (little_endian_32(bytes, 14) == kOldHeader) {
    found.size = {first & 0xFFFF, first >> 16};
    return found;
  }
  // Below 0 where the first row of the file is the picture's upper one.
  const auto height = static_cast<std::int64_t>(static_cast<std::int32_t>(little_endian_32(bytes, 22)));
  found.size = {static_cast<std::int32_t>(first), std::abs(height)};
  constexpr std::size_t kWholeHeader = 54;
  if (bytes.size() < kWholeHeader || end_of_bitmap(bytes, *found.size) > static_cast<double>(bytes.size()))
    found.damage = fmt::format("{}: the palette or the pixels of this bitmap are not all there", kCut);
  return found;
}

ImageIntegrity inspect_tiff(std::string_view bytes) {
  ImageIntegrity found{.kind = ImageKind::kTiff};
  const auto width = tiff_value(bytes, kTiffImageWidth), height = tiff_value(bytes, kTiffImageLength);
  if (width && height)
    found.size = {*width, *height};
  else
    found.damage = fmt::format("{}: a TIFF without width and height", kBroken);
  return found;
}

bool is_pnm(std::string_view bytes) {
  constexpr std::string_view kKinds = "2356";
  return bytes.size() > 2 && bytes[0] == 'P' && kKinds.find(bytes[1]) != std::string_view::npos &&
         std::isspace(byte_at(bytes, 2)) != 0;
}

/// OpenCV gives what its WebP decoder does not take to one of medical pictures, whose assertions end the
/// process (GDCM 3.0).
bool is_webp(std::string_view bytes) {
  constexpr std::size_t kMedicalMark = 128;
  return bytes.starts_with("RIFF") && bytes.size() > 12 && bytes.substr(8, 4) == "WEBP" &&
         !(bytes.size() > kMedicalMark && bytes.substr(kMedicalMark).starts_with("DICM"));
}

}  // namespace

ImageIntegrity inspect_image(std::string_view bytes) {
  if (bytes.empty()) return {.damage = "the file is empty (0 bytes)"};
  if (bytes.starts_with(kPngSignature)) return inspect_png(bytes);
  if (bytes.starts_with(kJpegSignature)) return JpegWalk(bytes).run();
  if (is_pnm(bytes)) return inspect_pnm(bytes);
  if (bytes.starts_with("BM")) return inspect_bmp(bytes);
  if (bytes.starts_with(std::string_view("II*\0", 4)) || bytes.starts_with(std::string_view("MM\0*", 4)))
    return inspect_tiff(bytes);
  if (is_webp(bytes)) return {.kind = ImageKind::kWebp};
  return {.damage = "is not an image that can be decoded: PNG, JPEG, BMP, TIFF, WebP, PGM and PPM are"};
}

std::string picture_of_png(std::string_view bytes) {
  std::string kept(kPngSignature);
  for (std::size_t at = kPngSignature.size(); const auto chunk = png_chunk_at(bytes, at);) {
    if (matters_to_pixels(*chunk)) kept += chunk->whole;
    if (chunk->type == "IEND") break;
    at += chunk->whole.size();
  }
  return kept;
}

}  // namespace apriltrack
