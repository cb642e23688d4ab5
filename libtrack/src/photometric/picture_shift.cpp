#include "picture_shift.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace apriltrack {

void PictureShifts::Prepared::prepare(const Image<float>& picture) {
  const int width = picture.width(), height = picture.height();
  double sum = 0.0, count = 0.0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (std::isnan(picture(x, y))) continue;
      sum += static_cast<double>(picture(x, y));
      count += 1.0;
    }
  }
  const auto mean = static_cast<float>(sum / std::max(1.0, count));
  if (light.width() != width || light.height() != height) light = Image<float>(width, height);
  const int stride = width + 1;
  sums.assign(static_cast<std::size_t>(stride * (height + 1)), 0.0);
  squares = sums;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float here = std::isnan(picture(x, y)) ? 0.0F : picture(x, y) - mean;
      light(x, y) = here;
      const auto value = static_cast<double>(here);
      const auto at = static_cast<std::size_t>((y + 1) * stride + x + 1);
      const auto above = at - static_cast<std::size_t>(stride);
      sums[at] = value + sums[at - 1] + sums[above] - sums[above - 1];
      squares[at] = value * value + squares[at - 1] + squares[above] - squares[above - 1];
    }
  }
}

double PictureShifts::Prepared::total(const std::vector<double>& of, int x0, int y0, int x1, int y1) const {
  const int stride = light.width() + 1;
  const auto at = [&](int x, int y) { return of[static_cast<std::size_t>(y * stride + x)]; };
  return at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0);
}

double PictureShifts::correlation(int dx, int dy) const {
  const int x0 = std::max(0, -dx), x1 = std::min(now_.light.width(), now_.light.width() - dx);
  const int y0 = std::max(0, -dy), y1 = std::min(now_.light.height(), now_.light.height() - dy);
  // Sums side by side, so that compilers may use vectors, and none waits for the one before.
  constexpr int kAbreast = 8;
  float partial[kAbreast] = {};
  float rest = 0.0F;
  for (int y = y0; y < y1; ++y) {
    const float *a = now_.light.row(y), *b = before_.light.row(y + dy) + dx;
    int x = x0;
    for (; x + kAbreast <= x1; x += kAbreast)
      for (int k = 0; k < kAbreast; ++k) partial[k] += a[x + k] * b[x + k];
    for (; x < x1; ++x) rest += a[x] * b[x];
  }
  const float products = std::accumulate(partial, partial + kAbreast, rest);
  const double n = static_cast<double>(x1 - x0) * (y1 - y0);
  const double sum_now = now_.total(now_.sums, x0, y0, x1, y1);
  const double sum_before = before_.total(before_.sums, x0 + dx, y0 + dy, x1 + dx, y1 + dy);
  const double of_now = now_.total(now_.squares, x0, y0, x1, y1) - sum_now * sum_now / n;
  const double of_before =
      before_.total(before_.squares, x0 + dx, y0 + dy, x1 + dx, y1 + dy) - sum_before * sum_before / n;
  if (!(of_now > 0.0 && of_before > 0.0)) return -1.0;
  return (static_cast<double>(products) - sum_now * sum_before / n) / std::sqrt(of_now * of_before);
}

PictureShift PictureShifts::best(const Image<float>& before, const Image<float>& now) {
  before_.prepare(before);
  now_.prepare(now);
  const int width = now.width(), height = now.height();
  const double least = least_common_share_ * width * height;
  PictureShift best;
  for (int dy = 1 - height; dy < height; ++dy) {
    for (int dx = 1 - width; dx < width; ++dx) {
      if (static_cast<double>((width - std::abs(dx)) * (height - std::abs(dy))) < least) continue;
      const double found = correlation(dx, dy);
      if (found > best.correlation) best = {dx, dy, found};
    }
  }
  return best;
}

}  // namespace apriltrack
