#pragma once

#include <cstdint>

namespace apriltrack {

/// sRGB.
struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  bool operator==(const Colour&) const = default;
};

// The palette of Okabe and Ito ("Color Universal Design", 2008), whose colours colour-blind eyes tell apart
// too, and a grey for what is to stand back.
inline constexpr Colour kBlack{0, 0, 0};
inline constexpr Colour kOrange{230, 159, 0};
inline constexpr Colour kSkyBlue{86, 180, 233};
inline constexpr Colour kBluishGreen{0, 158, 115};
inline constexpr Colour kYellow{240, 228, 66};
inline constexpr Colour kBlue{0, 114, 178};
inline constexpr Colour kVermilion{213, 94, 0};
inline constexpr Colour kReddishPurple{204, 121, 167};
inline constexpr Colour kPaleGrey{190, 190, 190};

}  // namespace apriltrack
