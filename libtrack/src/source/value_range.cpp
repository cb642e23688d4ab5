#include "value_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <opencv2/core.hpp>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

constexpr int kLargest = 65535;
/// Of sensors. Data that reach into the two upper bits fill at least a quarter of the scale as they are.
constexpr std::array kSensorBits = {8, 10, 12, 14};

/// Two pixels on, and back where the picture ends: the next ones of the same colour in a raw mosaic.
int next_of_colour(int i, int size) {
  return i + 2 < size ? i + 2 : std::max(0, i - 2);
}
int last_of_colour(int i, int size) {
  return i >= 2 ? i - 2 : next_of_colour(i, size);
}

}  // namespace

void ValueCounts::add(const cv::Mat& picture) {
  APRILTRACK_CHECK(picture.type() == CV_16UC1, "values are counted in 16-bit pictures of one channel");
  for (int y = 0; y < picture.rows; ++y) {
    const auto* row = picture.ptr<std::uint16_t>(y);
    const auto* above = picture.ptr<std::uint16_t>(last_of_colour(y, picture.rows));
    const auto* below = picture.ptr<std::uint16_t>(next_of_colour(y, picture.rows));
    for (int x = 0; x < picture.cols; ++x) {
      const auto [darkest, brightest] = std::minmax(
          {row[last_of_colour(x, picture.cols)], row[next_of_colour(x, picture.cols)], above[x], below[x]});
      ++dark_[std::max(row[x], darkest)];
      ++bright_[std::min(row[x], brightest)];
    }
  }
  num_pixels_ += static_cast<std::int64_t>(picture.rows) * picture.cols;
}

std::int64_t ValueCounts::num_odd() const {
  constexpr std::int64_t kOneIn = 100'000, kOfSmallPictures = 8;
  return std::min(std::max(num_pixels_ / kOneIn, kOfSmallPictures), num_pixels_ / 100);
}

int ValueCounts::lowest() const {
  std::int64_t below = 0;
  int value = 0;
  while (value < kLargest && (below += dark_[static_cast<std::size_t>(value)]) <= num_odd()) ++value;
  return value;
}

int ValueCounts::highest() const {
  std::int64_t above = 0;
  int value = kLargest;
  while (value > 0 && (above += bright_[static_cast<std::size_t>(value)]) <= num_odd()) --value;
  return value;
}

ValueRange ValueCounts::range() const {
  const int low = lowest(), high = highest();
  const auto bits = std::ranges::find_if(kSensorBits, [&](int b) { return high < 1 << b; });
  const ValueRange whole = bits == kSensorBits.end() ? ValueRange{} : range_of_bits(*bits);
  // Fewer than 32 of 256 grey levels would be left. Of less than 64 numbers noise would be made a picture.
  constexpr int kNarrow = 8, kFewest = 64;
  const int width = high - low;
  if (kNarrow * width >= whole.white || width < kFewest) return whole;
  return {std::max(0, low - width / 2), std::min(kLargest, high + width / 2)};
}

ValueRange range_of_bits(int bits) {
  return {0, (1 << bits) - 1};
}

std::optional<int> ValueRange::bits() const {
  const auto largest = static_cast<unsigned>(white);
  if (black != 0 || !std::has_single_bit(largest + 1)) return std::nullopt;
  return static_cast<int>(std::bit_width(largest));
}

std::string description_of(const ValueRange& range) {
  const std::optional<int> bits = range.bits();
  if (!bits) return fmt::format("the range {} to {}", range.black, range.white);
  return fmt::format("{} bits (0 to {})", *bits, range.white);
}

}  // namespace apriltrack
