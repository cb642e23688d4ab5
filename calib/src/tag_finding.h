#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace apriltrack {

/// What is wrong with a tag, told in words that a user can act on.
struct TagFinding {
  enum class Kind { kSize, kMoved, kTwoPlaces, kNotFlat, kLoose };
  int tag = 0;
  Kind kind = Kind::kSize;
  /// Two places as far apart as tags hang that are there at a time, in whatever order they were seen.
  bool may_be_copies = false;
  std::string words;
  bool is_left_out = false;
  bool is_in_doubt = false;   ///< Another may be at fault in its place, and the views do not tell which.
  bool may_fold_map = false;  ///< The other is in it.
  /// What the views cost, in units of what they would if they erred as expected: with one place and the
  /// stated shape, and with what was found.
  double misfit_before = 0.0, misfit_after = 0.0;
  std::size_t num_views = 0;  ///< That this rests on.
  /// Views of the tag at its one place and at its other, as far as they were looked at; empty where there are
  /// not two.
  std::array<std::vector<std::size_t>, 2> views_by_place = {};
  double log_scale = 0.0;  ///< Of a kSize: the logarithm of the size that it has, over the stated one.
  double explained = 0.0;  ///< Half the squares, of all views, less a fee for the unknowns; if known.

  /// Nothing is left to be explained, or hardly anything of much; or nothing can be of what has no fixed
  /// place.
  bool is_complete() const {
    const double most_left = kind == Kind::kSize ? 0.15 : 0.1;
    return kind == Kind::kLoose || misfit_after < 1.6 ||
           (kind != Kind::kNotFlat && misfit_after < most_left * misfit_before);
  }
  double gain() const { return (misfit_before - misfit_after) * static_cast<double>(num_views); }
};

}  // namespace apriltrack
