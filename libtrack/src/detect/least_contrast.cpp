#include "least_contrast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace apriltrack {
namespace {

constexpr int kLeast = 5;         // the library's own
constexpr double kMost = 20.0;    // light and dark parts of an image have a grain of their own
constexpr int kSide_px = 12;      // what the library compares: a tile of 4 x 4 pixels, and those around it
constexpr double kOfGrain = 0.5;  // the range on a border grows by more

/// The range that a quarter of the image's squares keep within: those in which there is nothing to see.
double range_of_grain(const GrayView& image) {
  // A band of rows at once, column by column, in which the compiler takes sixteen columns a step.
  const auto width = static_cast<std::size_t>(image.width());
  std::vector<std::uint8_t> darkest(width), brightest(width);
  std::vector<int> ranges;
  for (int top = 0; top + kSide_px <= image.height(); top += kSide_px) {
    std::ranges::fill(darkest, std::uint8_t{255});
    std::ranges::fill(brightest, std::uint8_t{0});
    for (int y = top; y < top + kSide_px; ++y) {
      const std::uint8_t* row = image.row(y);
      for (std::size_t x = 0; x < width; ++x) {
        darkest[x] = std::min(darkest[x], row[x]);
        brightest[x] = std::max(brightest[x], row[x]);
      }
    }
    for (std::size_t left = 0; left + kSide_px <= width; left += kSide_px)
      ranges.push_back(*std::max_element(&brightest[left], &brightest[left] + kSide_px) -
                       *std::min_element(&darkest[left], &darkest[left] + kSide_px));
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
