#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tag_probe.h"

namespace apriltrack {

// Another shape is clear by so many standard deviations, and so much of the tag's size.
inline constexpr double kClearSigmas = 4.5, kClearScale = 0.012, kClearBend = 0.006;

/// What is wrong with a tag, told in words that a user can act on.
struct TagFinding {
  enum class Kind { kSize, kMoved, kTwoPlaces, kNotFlat, kLoose };
  int tag = 0;
  Kind kind = Kind::kSize;
  std::string words;
  bool is_left_out = false;
  /// What the views cost, in units of what they would if they erred as expected: with one place and the
  /// stated shape, and with what was found.
  double misfit_before = 0.0, misfit_after = 0.0;
  std::size_t num_views = 0;  ///< That this rests on.
  double explained = 0.0;     ///< Half the squares, of all views, less a fee for the unknowns; if known.

  /// Nothing is left to be explained, or nothing can be of what has no fixed place.
  bool is_complete() const { return kind == Kind::kLoose || misfit_after < 1.6; }
  double gain() const { return (misfit_before - misfit_after) * static_cast<double>(num_views); }
};

struct TagLook {
  /// What the views of one place with the stated shape cost, in units of what they would if they erred as
  /// expected; 0 where there are too few.
  double misfit = 0.0;
  /// None where nothing is clearly wrong, or nothing explains it.
  std::optional<TagFinding> finding;
};

/// Whether something explains the tag's views where one place and the stated shape do not: another size, a
/// bend, two places, one after the other or by turns, or no fixed place at all. probes: in the order of time.
/// solved: the map that foretells them.
TagLook look_at(const PartTask& task, const AdjustedPart& solved, const std::vector<ProbeView>& probes,
                int tag);

}  // namespace apriltrack
