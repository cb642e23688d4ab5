#pragma once

#include <optional>

#include "apriltrack/image/image.h"
#include "apriltrack/image/response.h"
#include "apriltrack/tags/tag_family.h"
#include "edge_frame.h"
#include "edge_sampling.h"

namespace apriltrack {

struct RefinedCorners {
  Quad corners_px;
  double blur_sigma_px = 0.0;  ///< Across the edges, root mean square; the pixel's own area included.
};

/// Corners as intersections of curves fitted to the four edges in linear light (docs/algorithms/detector.md).
///
/// Samples lie across each edge, inside up to two and a half cells deep and outside as far as the family
/// prints, and are compared with the tag's own cells under blur: so data bits and small or blurred cells do
/// not pull the edge. pattern: of the tag that was read. is_white_inside: the family's border is reversed.
/// start_px: the quad as found, right to about a cell. margin_cells: as TagEdge's.
/// nullopt when an edge cannot be fitted or a corner would move by more than what the start may be wrong.
std::optional<RefinedCorners> refine_corners(const GrayView& image, const ResponseCurve& response,
                                             const TagPattern& pattern, bool is_white_inside,
                                             const Quad& start_px, double margin_cells = kWholeMargin_cells);

}  // namespace apriltrack
