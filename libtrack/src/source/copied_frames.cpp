#include "apriltrack/source/copied_frames.h"

#include <fmt/format.h>

#include <bit>
#include <utility>

#include "apriltrack/image/blank.h"

namespace apriltrack {
namespace {

/// FNV-1a's idea, on pixels that are spread over 64 bits; equal by chance once in 10^19 pictures.
std::uint64_t digest_of(const GrayView& image) {
  constexpr std::uint64_t kPrime = 0x9E3779B97F4A7C15U;  // the golden ratio's, odd
  std::uint64_t digest =
      static_cast<std::uint64_t>(image.width()) << 32 | static_cast<std::uint64_t>(image.height());
  for (int y = 0; y < image.height(); ++y) {
    const std::uint8_t* row = image.row(y);
    for (int x = 0; x < image.width(); ++x) digest = std::rotl((digest ^ row[x]) * kPrime, 29);
  }
  return digest;
}

}  // namespace

bool CopyWatch::is_copy(const SourceFrame& frame) {
  if (!frame.is_readable()) return false;
  const std::uint64_t digest = digest_of(frame.pixels.view());
  const bool is_same = std::exchange(previous_, digest) == digest;
  return is_same && !is_blank(frame.pixels.view());
}

std::string message_of_copies(std::size_t copies, std::size_t frames, const std::string& first) {
  return fmt::format(
      "{} of {} frames {} of the frame before, pixel by pixel, under a time of {} own; the first: {}. A "
      "recorder or a "
      "converter repeats pictures: take the copies out, for motion stops where they are",
      copies, frames, copies == 1 ? "is a copy" : "are copies", copies == 1 ? "its" : "their", first);
}

}  // namespace apriltrack
