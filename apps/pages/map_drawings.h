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
  std::vector<MapTag> left_out = {};  ///< Tags that are not in the map, where their own views put them.
  double ellipse_scale = 1.0;  ///< By how much ellipses are drawn too large: the same on the whole page.
  /// Covariances are of a frame that was measured, and no tag is held.
  bool is_frame_measured = false;
  bool is_vertical_measured = false;  ///< z of the map is up.
};

struct MapDrawing {
  std::vector<SvgPicture> pictures;
  std::string caption;
};

/// A scale with which the largest ellipse of all these maps is seen well in their drawings: a round number,
/// at least 1.
double ellipse_scale_for(const std::vector<DrawnMap>& all);

/// Up in the map's frame: as measured, or as the camera was held.
Eigen::Vector3d up_of(const DrawnMap& drawn);
/// Whether the page warns of it: its flags, or a direction that is known much less well than others.
bool is_doubtful(const DrawnMap& drawn, const MapTag& tag);

/// Tags as they hang, with their normals, numbers and ellipses of uncertainty, and the camera's path: from
/// above.
MapDrawing draw_from_above(const DrawnMap& drawn);
/// The same from two sides.
MapDrawing draw_from_sides(const DrawnMap& drawn);
/// Which tags are seen together, and how often.
MapDrawing draw_links(const DrawnMap& drawn);

}  // namespace apriltrack::app
