#pragma once

#include <optional>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "cameras/camera_refinement.h"

namespace apriltrack {

/// Of the cameras of a part.
struct BetterCameras {
  CameraRefinement refined;
  /// That agree clearly better, where the user keeps his.
  std::optional<CameraRefinement> lens_not_taken, places_not_taken;
  /// What is not among `refined`, and which the views propose, but frames that were held out do not decide.
  std::optional<CameraRefinement> open;
  /// The views' candidates by these cameras, where all was solved again by them; none where those by the
  /// file's will do.
  std::vector<ViewCandidates> candidates;
};

/// Whether a lens or a place is farther off than files of the same camera usually are.
bool is_far_from_file(const CameraRefinement& cameras);

/// Estimates edge offsets, lenses, and where it is asked for the cameras' places, and takes them into
/// `solved` where the views agree better with them. A wrong lens makes views outliers, two-fold or noisy
/// that are none of that: with one that is far from the file's all is solved again by it, until it stays.
/// part: before outliers were removed. Throws Error(kNoResult) where the file is wrong by far, and the views
/// do not tell what is right.
BetterCameras improve_cameras(const PartTask& task, const Part& part, const ParallelFor& parallel,
                              AdjustedPart& solved);

/// The same once more, after tags were left out of `solved`: what was wrong with them may have been in the
/// cameras' numbers, or have kept these from being better. Throws as improve_cameras does.
void improve_cameras_again(const PartTask& task, const Part& part, const ParallelFor& parallel,
                           AdjustedPart& solved, BetterCameras& cameras);

}  // namespace apriltrack
