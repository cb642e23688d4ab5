#include "canvas.h"

#include <algorithm>
#include <cmath>

namespace apriltrack {

Canvas::Canvas(double width_m, double height_m, double texel_m, float reflectance)
    : width_m_(width_m),
      height_m_(height_m),
      texel_m_(texel_m),
      picture_(std::max(2, static_cast<int>(std::ceil(width_m / texel_m))),
               std::max(2, static_cast<int>(std::ceil(height_m / texel_m))), reflectance) {}

int Canvas::texel(double metres) const {
  return static_cast<int>(std::floor(metres / texel_m_ + 0.5));
}

void Canvas::rectangle(double x, double y, double width, double height, double reflectance) {
  const int x_0 = std::max(texel(x), 0);
  const int x_1 = std::min(texel(x + width), picture_.width());
  const int y_1 = std::min(texel(y + height), picture_.height());
  for (int row = std::max(texel(y), 0); row < y_1; ++row) {
    if (x_1 > x_0)
      std::fill(picture_.row(row) + x_0, picture_.row(row) + x_1, static_cast<float>(reflectance));
  }
}

void Canvas::disc(double x, double y, double radius, double reflectance) {
  for (double up = -radius; up < radius; up += texel_m_) {
    const double half = std::sqrt(std::max(radius * radius - up * up, 0.0));
    rectangle(x - half, y + up, 2.0 * half, 1.01 * texel_m_, reflectance);
  }
}

void Canvas::text(double x, double y, double width, double height, double line_m, double reflectance,
                  RandomStream& random) {
  for (double up = y; up + line_m <= y + height; up += 1.8 * line_m) {
    const double end = x + width * random.uniform(0.55, 1.0);
    for (double right = x; right < end;) {
      const double word = line_m * random.uniform(0.8, 4.5);
      rectangle(right, up, std::min(word, end - right), line_m, reflectance);
      right += word + 0.7 * line_m;
    }
  }
}

void Canvas::stripes(double x, double y, double width, double height, double period_m, bool is_upright,
                     double reflectance) {
  const double length = is_upright ? width : height;
  for (double along = 0.0; along < length; along += period_m) {
    const double thickness = std::min(0.5 * period_m, length - along);
    if (is_upright) {
      rectangle(x + along, y, thickness, height, reflectance);
    } else {
      rectangle(x, y + along, width, thickness, reflectance);
    }
  }
}

void Canvas::false_tag(double x, double y, double size, RandomStream& random) {
  const double cell = size / 8.0;
  rectangle(x - cell, y - cell, size + 2.0 * cell, size + 2.0 * cell, 0.78);
  rectangle(x, y, size, size, 0.05);
  for (int row = 1; row < 7; ++row) {
    for (int column = 1; column < 7; ++column) {
      if (random.uniform() < 0.5) rectangle(x + column * cell, y + row * cell, cell, cell, 0.78);
    }
  }
  rectangle(x + 2.0 * cell, y, 3.0 * cell, 1.5 * cell, 0.78);
  rectangle(x, y + 3.0 * cell, 1.5 * cell, 2.0 * cell, 0.78);
}

void Canvas::grain(double share, RandomStream& random) {
  for (int y = 0; y < picture_.height(); ++y) {
    for (int x = 0; x < picture_.width(); ++x) {
      picture_(x, y) *= static_cast<float>(1.0 + share * (2.0 * random.uniform() - 1.0));
    }
  }
}

float Canvas::at(double x, double y) const {
  const int column = std::clamp(static_cast<int>(x / texel_m_), 0, picture_.width() - 1);
  const int row = std::clamp(static_cast<int>(y / texel_m_), 0, picture_.height() - 1);
  return picture_(column, row);
}

}  // namespace apriltrack
