#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "apriltrack/tags/tag_family.h"
#include "edge_fit.h"
#include "edge_frame.h"
#include "light_sampler.h"

namespace apriltrack {

inline constexpr double kWholeMargin_cells = 1e9;

/// One edge of a printed tag, and what is assumed of it in the picture.
struct TagEdge {
  const TagPattern& pattern;
  bool is_white_inside = false;
  Eigen::Matrix3d homography;  ///< From tag coordinates, [-1, 1] at the corners, to pixels.
  std::size_t index = 0;       ///< From corner `index` to the next.
  /// How far beyond the border what the family prints there can be relied on; no farther than it prints.
  double margin_cells = kWholeMargin_cells;
};

struct EdgeGuess {
  double reach_px = 0.0;  ///< How far to look on either side.
  double sigma_px = 0.0;
};

/// What fit_edge() takes.
struct EdgeSamples {
  std::vector<EdgeSample> samples;
  std::vector<EdgeProfile> profiles;
};

/// Light across the edge, inside up to two and a half cells deep and outside as far as the family prints,
/// with the tag's own profile for every column. sigma_along_px: blur along the edge.
EdgeSamples sample_edge(const LightSampler& sampler, const TagEdge& edge, const EdgeFrame& frame,
                        const EdgeGuess& guess, double sigma_along_px);

}  // namespace apriltrack
