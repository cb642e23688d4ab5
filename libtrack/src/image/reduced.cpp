#include "apriltrack/image/reduced.h"

#include <algorithm>

namespace apriltrack {
namespace {

GrayImage halved(const GrayView& image) {
  GrayImage half(image.width() / 2, image.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    const std::uint8_t* upper = image.row(2 * y);
    const std::uint8_t* lower = image.row(2 * y + 1);
    std::uint8_t* target = half.row(y);
    for (int x = 0; x < half.width(); ++x)
      target[x] = static_cast<std::uint8_t>(
          (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1] + 2) / 4);
  }
  return half;
}

}  // namespace

GrayImage reduced_copy(const GrayView& image, std::int64_t most_pixels) {
  const auto pixels = [](const GrayView& one) { return std::int64_t{one.width()} * one.height(); };
  if (pixels(image) <= most_pixels) {
    GrayImage copy(image.width(), image.height());
    for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), image.width(), copy.row(y));
    return copy;
  }
  GrayImage half = halved(image);
  while (pixels(half.view()) > most_pixels) half = halved(half.view());
  return half;
}

}  // namespace apriltrack
