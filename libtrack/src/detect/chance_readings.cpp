#include "apriltrack/detect/chance_readings.h"

#include <algorithm>

namespace apriltrack {
namespace {

/// Squares of a frame that are no tags of the family, but whose four edges can be fitted. Every 15th frame of
/// 13 films and photos has 1 to 8 of them, and 3 on average; sheets full of other markers, where tags are
/// taken for others', have 30 and, of 60 markers, 49.
constexpr double kSquaresPerFrame = 30.0;
/// Of these, the part whose picture correlates with the tag that their own bits spell by
/// kLeastPatternCorrelation: 1 of 1708 (at most 3, with 90 % confidence).
constexpr double kShareLikeATag = 0.002;

/// -1: none.
int most_corrected_bits(const TagFamily& family, double squares_per_frame) {
  int most = -1;
  while (most < family.max_corrected_bits() &&
         squares_per_frame * family.chance_of_reading(most + 1) <= kMostChanceReadings)
    ++most;
  return most;
}

}  // namespace

int corrected_bits_by_code(const TagFamily& family) {
  return most_corrected_bits(family, kSquaresPerFrame);
}

int corrected_bits_by_picture(const TagFamily& family) {
  return most_corrected_bits(family, kSquaresPerFrame * kShareLikeATag);
}

double chance_readings_per_frame(const TagFamily& family, int corrected_bits) {
  const auto up_to = [&](int bits) { return bits < 0 ? 0.0 : family.chance_of_reading(bits); };
  const double by_code = up_to(std::min(corrected_bits, corrected_bits_by_code(family)));
  const double all = up_to(std::min(corrected_bits, corrected_bits_by_picture(family)));
  return kSquaresPerFrame * (by_code + kShareLikeATag * (all - by_code));
}

}  // namespace apriltrack
