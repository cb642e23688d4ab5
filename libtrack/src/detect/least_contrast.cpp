#include "least_contrast.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace apriltrack {
namespace {

constexpr int kLeast = 5;         // the library's own
constexpr double kMost = 20.0;    // light and dark parts of an image have a grain of their own
constexpr int kSide_px = 12;      // what the library compares: a tile of 4 x 4 pixels, and those around it
constexpr double kOfGrain = 0.5;  // the range on a border grows by more

double range_of(const GrayView& image, int left, int top) {
  std::uint8_t darkest = 255, brightest = 0;
  for (int y = top; y < top + kSide_px; ++y) {
    const auto [low, high] = std::minmax_element(image.row(y) + left, image.row(y) + left + kSide_px);
    darkest = std::min(darkest, *low);
    brightest = std::max(brightest, *high);
  }
  return brightest - darkest;
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
