#pragma once

#include <array>

namespace apriltrack {

/// By which pictures of one sensor differ: 640 x 480 to 800 x 600, 1024 x 768, 1280 x 960, ...
inline constexpr std::array<double, 14> kPictureScales = {1.25, 4.0 / 3.0, 1.5, 1.6, 5.0 / 3.0, 2.0, 2.25,
                                                          2.5,  8.0 / 3.0, 3.0, 4.0, 5.0,       6.0, 8.0};

}  // namespace apriltrack
