#include "joined_borders.h"

#include <algorithm>
#include <vector>

namespace apriltrack {

GrayImage shrink_black(const GrayView& image) {
  const int width = image.width();
  const int height = image.height();
  // Columns first, then rows: the maximum over a square is the maximum of its columns' maxima.
  std::vector<std::uint8_t> column(static_cast<std::size_t>(width));
  GrayImage out(width, height);
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* above = image.row(std::max(y - 1, 0));
    const std::uint8_t* here = image.row(y);
    const std::uint8_t* below = image.row(std::min(y + 1, height - 1));
    for (int x = 0; x < width; ++x)
      column[static_cast<std::size_t>(x)] = std::max({above[x], here[x], below[x]});
    std::uint8_t* target = out.row(y);
    for (int x = 0; x < width; ++x) {
      const auto left = static_cast<std::size_t>(std::max(x - 1, 0));
      const auto right = static_cast<std::size_t>(std::min(x + 1, width - 1));
      target[x] = std::max({column[left], column[static_cast<std::size_t>(x)], column[right]});
    }
  }
  return out;
}

GrayImage enlarge_twice(const GrayView& image) {
  GrayImage out(2 * image.width(), 2 * image.height());
  // Centres of the new pixels lie a quarter of an old one to either side.
  for (int y = 0; y < out.height(); ++y) {
    const std::uint8_t* near = image.row(y / 2);
    const std::uint8_t* far = image.row(std::clamp(y / 2 + (y % 2 ? 1 : -1), 0, image.height() - 1));
    std::uint8_t* target = out.row(y);
    for (int x = 0; x < out.width(); ++x) {
      const int near_x = x / 2;
      const int far_x = std::clamp(near_x + (x % 2 ? 1 : -1), 0, image.width() - 1);
      target[x] = static_cast<std::uint8_t>(
          (9 * near[near_x] + 3 * near[far_x] + 3 * far[near_x] + far[far_x] + 8) / 16);
    }
  }
  return out;
}

}  // namespace apriltrack
