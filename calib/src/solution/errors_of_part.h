#pragma once

#include <optional>
#include <vector>

#include "solution/part_solution.h"
#include "uncertainty/tag_covariance.h"

namespace apriltrack {

/// What a map's covariances count beside the noise and the errors that each tag keeps: cameras that were
/// estimated, with the poses or of another part, or that were left open; prints that may not be as stated;
/// and pictures of other moments. nullopt where there are none. views: those of the part, linearised; poses:
/// made from them.
std::optional<SharedErrors> errors_of_part(const Observations& observations, const PartSolution& solution,
                                           const std::vector<LinearView>& views,
                                           const PoseInformation& poses);

/// The same as independent errors of variance one that these views take as the whole recording has them.
/// views: some of the part's; state: of a map that was made from them.
std::vector<ParameterView> taken_errors(const Observations& observations, const PartSolution& solution,
                                        const std::vector<std::size_t>& views, const MapState& state);

}  // namespace apriltrack
