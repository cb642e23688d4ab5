#pragma once

#include <optional>
#include <set>
#include <vector>

#include "hypotheses/better_cameras.h"

namespace apriltrack {

/// Paper that a printer feeds too fast or too slow makes all tags wider than high, or narrower, and looks as
/// a lens does whose pixels are not square; which they are to about half a percent. The width over the
/// height of tags, less one (to first order), where fy / fx of each of `used`, the cameras that see them, is
/// estimated, and all say the same. By those that are taken; or else by those that are left open.
std::optional<double> find_print_aspect(const BetterCameras& cameras, const std::set<int>& used);
/// By one estimate of them.
std::optional<double> find_print_aspect(const CameraRefinement& cameras, const std::set<int>& used);

/// Those that are taken.
CameraParameters aspects_of(const CameraRefinement& refined);

/// How the views depend on two errors of unit variance: that tags are printed so, and the lenses are as
/// stated; and that the size is stated of one side or the other. refined: the fy / fx that were taken as the
/// cause; none where the cameras are without.
std::vector<ParameterView> aspect_errors(const Observations& observations,
                                         const std::vector<std::size_t>& views, const MapState& state,
                                         double print_aspect, CameraParameters refined);

}  // namespace apriltrack
