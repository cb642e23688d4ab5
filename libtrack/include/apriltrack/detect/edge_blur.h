#pragma once

#include <optional>

#include "apriltrack/detect/detection.h"
#include "apriltrack/image/image.h"
#include "apriltrack/image/response.h"

namespace apriltrack {

/// How far a tag's edges are smeared in the picture: standard deviation in px of the blur across them, in
/// linear light, what the lens and the pixels' own area do included. Motion smears edges that lie across its
/// way: of the two pairs of opposite edges, the more blurred one's.
///
/// detection: corners right to about a pixel, as a Detector of this image finds them; its family must be
/// known. nullopt where an edge is hidden or cut by the image's border. Sharp pictures have 0.6 to 0.8; blur
/// so long that no tag is read is not seen here.
std::optional<double> edge_blur_sigma_px(const GrayView& image, const ResponseCurve& response,
                                         const Detection& detection);

/// The path in px, straight and even during the exposure, that would smear an edge across it by `sigma_px`
/// where a lens in focus (0.5 px) films with pixels of full area; 0 for what is no blurrier than that.
double motion_of_blur_px(double sigma_px);

}  // namespace apriltrack
