#include "least_contrast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace apriltrack {
namespace {

constexpr int kLeast = 5;         // the library's own
constexpr double kMost = 20.0;    // light and dark parts of an image have a grain of their own
constexpr int kSide_px = 12;      // what the library compares: a tile of 4 x 4 pixels, and those around it
constexpr double kOfGrain = 0.5;  // the range on a border grows by more

double range_of(const GrayView& image, int left, int top) {
  // Column by column, so that the compiler takes twelve columns at once: a seventh of the time.
  std::array<std::uint8_t, kSide_px> darkest, brightest;
  darkest.fill(255);
  brightest.fill(0);
  for (int y = top; y < top + kSide_px; ++y) {
    const std::uint8_t* row = image.row(y) + left;
    for (std::size_t x = 0; x < kSide_px; ++x) {
      darkest[x] = std::min(darkest[x], row[x]);
      brightest[x] = std::max(brightest[x], row[x]);
    }
  }
  return *std::max_element(brightest.begin(), brightest.end()) -
         *std::min_element(darkest.begin(), darkest.end());
}

/// The range that a quarter of the image's squares keep within: those in which there is nothing to see.
double range_of_grain(const GrayView& image) {
  std::vector<double> ranges;
  for (int top = 0; top + kSide_px <= image.height(); top += kSide_px) {
    for (int left = 0; left + kSide_px <= image.width(); left += kSide_px)
      ranges.push_back(range_of(image, left, top));
  }
  if (ranges.empty()) return 0.0;
  const auto quarter = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 4);
  std::nth_element(ranges.begin(), quarter, ranges.end());
  return *quarter;
}

}  // namespace

int least_contrast(const GrayView& image, double min_decision_margin) {
  const double of_tag = std::min(2.0 * min_decision_margin, 0.5 * kMost);
  const double with_grain = of_tag + kOfGrain * range_of_grain(image);
  return std::max(kLeast, static_cast<int>(std::min(kMost, with_grain)));
}

}  // namespace apriltrack
