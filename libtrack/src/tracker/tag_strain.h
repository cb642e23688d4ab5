#pragma once

#include <vector>

#include "apriltrack/photometric/tag_equations.h"

namespace apriltrack {

/// How far a tag would rather be from where the map has it, as the tags that the state rests on show it.
struct TagStrain {
  int tag_index = 0;
  double chi2 = 0.0;      ///< Of that displacement, six numbers.
  double shift_px = 0.0;  ///< What it moves the tag's corners by, root mean square.
  /// What chi2 a tag would show, on the average, that was moved by a quarter of its size and 15 degrees.
  double power = 0.0;

  /// Right maps reach 22 in photoreal recordings, without any allowance for the map.
  static constexpr double kMaxChi2 = 50.0;
  static constexpr double kUsualChi2 = 15.0;
  bool is_strained() const { return chi2 > kMaxChi2; }
  /// It would have been seen.
  bool is_right() const { return chi2 < kUsualChi2 && power > 2.0 * kMaxChi2; }
};

/// The score test (Rao 1948) of each explained tag's pose in the map: freed alone, how far would it move, and
/// is that more than noise, what all pixels of a tag share, and a map as usual allow? Docs:
/// docs/algorithms/blur_tracker.md, section 7. The state rests on the tags that are not hidden.
std::vector<TagStrain> tag_strains(const PhotometricWorld& world, const MotionState& state,
                                   const std::vector<TagEquations>& tags);

}  // namespace apriltrack
