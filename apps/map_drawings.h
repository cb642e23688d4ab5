#pragma once

#include <string>
#include <vector>

#include "apriltrack/calib/assess_map.h"
#include "apriltrack/report/svg_picture.h"

namespace apriltrack::app {

/// A map and what is known of it, to be drawn.
struct DrawnMap {
  const TagMap& map;
  const MapEvidence& evidence;
  const MapAssessment& assessment;
  /// Covariances are of a frame that was measured, and no tag is held.
  bool is_frame_measured = false;
  bool is_vertical_measured = false;  ///< z of the map is up.
};

struct MapDrawing {
  std::vector<SvgPicture> pictures;
  std::string caption;
};

/// Tags as they hang, with their normals, numbers and ellipses of uncertainty, and the camera's path: from
/// above.
MapDrawing draw_from_above(const DrawnMap& drawn);
/// The same from two sides.
MapDrawing draw_from_sides(const DrawnMap& drawn);
/// Which tags are seen together, and how often.
MapDrawing draw_links(const DrawnMap& drawn);

}  // namespace apriltrack::app
