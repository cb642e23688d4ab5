#include "apriltrack/image/blank.h"

#include <algorithm>

namespace apriltrack {
namespace {

constexpr int kBlock_px = 16;

double mean_of_block(const GrayView& image, int left, int top) {
  const int right = std::min(left + kBlock_px, image.width()),
            bottom = std::min(top + kBlock_px, image.height());
  double sum = 0.0;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) sum += image(x, y);
  return sum / ((right - left) * (bottom - top));
}

}  // namespace

bool is_blank(const GrayView& image) {
  constexpr double kMostRange = 4.0;
  double darkest = 255.0, brightest = 0.0;
  for (int top = 0; top < image.height(); top += kBlock_px) {
    for (int left = 0; left < image.width(); left += kBlock_px) {
      const double mean = mean_of_block(image, left, top);
      darkest = std::min(darkest, mean);
      brightest = std::max(brightest, mean);
      if (brightest - darkest > kMostRange) return false;
    }
  }
  return true;
}

}  // namespace apriltrack
