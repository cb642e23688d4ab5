#pragma once

#include <string>
#include <vector>

#include "apriltrack/report/map_elevation.h"
#include "apriltrack/report/svg_picture.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// A tag on paper.
struct DrawnTag {
  MapTag tag;        ///< T_map_tag: in the map's frame, or the frame that the elevation projects.
  std::string name;  ///< Its label.
  SvgInk ink = SvgInk::kText;
  SvgInk fill = SvgInk::kPaper;
  bool takes_part = true;    ///< Others are dashed and crossed.
  std::string tooltip = {};  ///< Where empty, what the map says of it.
};

/// What a drawing says of a tag to who points at it.
std::string tooltip_of(const MapTag& tag);

/// A frame, and a grid of lines a round number of metres apart.
void draw_paper(const PaperScale& scale, SvgPicture& picture);
/// Over all else: what is seen, and how long one cell of the grid is.
void draw_title_and_scale(const std::string& title, const PaperScale& scale, SvgPicture& picture);

/// Outlines with the direction that tags face, and their names behind them where there is room.
void draw_tags(const std::vector<DrawnTag>& tags, const Elevation& elevation, const PaperScale& scale,
               SvgPicture& picture);

}  // namespace apriltrack
