#pragma once

#include <vector>

#include "apriltrack/calib/systematic_errors.h"
#include "uncertainty/linear_part.h"

namespace apriltrack {

/// What the views say of when the cameras took them, to first order, every pose free to follow: a camera
/// whose rows are read one after another, and one of several that sees other moments than the first does at
/// the same times. Only what is clear. How fast corners move is asked of the map, at the moments before and
/// after: a recording of which these are too far apart says nothing.
std::vector<TimeError> find_time_errors(const Observations& observations, const LinearPart& part,
                                        const MapState& state);

/// As they were found before outliers went, and a lens was refined, where they were larger then: both take up
/// a part of them. What is gone since, a lens was.
std::vector<TimeError> by_the_larger(std::vector<TimeError> errors, const std::vector<TimeError>& before);

/// Those of another part's map first, then what is new.
std::vector<TimeError> with_known(std::vector<TimeError> known, const std::vector<TimeError>& found);

/// How the views depend on each of them as an error of unit variance. They may be other views of the same
/// recording, and `state` of a map of these.
std::vector<ParameterView> columns_of_time_errors(const Observations& observations,
                                                  const std::vector<std::size_t>& views,
                                                  const MapState& state,
                                                  const std::vector<TimeError>& errors);

}  // namespace apriltrack
