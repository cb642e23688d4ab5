#pragma once

#include <Eigen/Core>
#include <limits>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// Between four pixels. NaN beyond the picture, and beside pixels that are NaN. slope: per pixel.
inline float light_at(const Image<float>& picture, float x, float y, Eigen::Vector2f* slope = nullptr) {
  if (!(x >= 0.0F && y >= 0.0F && x < static_cast<float>(picture.width() - 1) &&
        y < static_cast<float>(picture.height() - 1)))
    return std::numeric_limits<float>::quiet_NaN();
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const float fx = x - static_cast<float>(left), fy = y - static_cast<float>(top);
  const float *a = picture.row(top) + left, *b = picture.row(top + 1) + left;
  const float upper = a[0] + fx * (a[1] - a[0]), lower = b[0] + fx * (b[1] - b[0]);
  if (slope != nullptr) *slope = {a[1] - a[0] + fy * (b[1] - b[0] - a[1] + a[0]), lower - upper};
  return upper + fy * (lower - upper);
}

}  // namespace apriltrack
