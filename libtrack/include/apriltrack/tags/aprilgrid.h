#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "apriltrack/tags/tag_family.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// Kalibr's printed calibration board: tags of tag36h11b2 in rows and columns, with a black square at every
/// crossing of the white lanes between them (kalibr_create_target_pdf). Tag (row, column) has id first_id +
/// row * columns + column, counted from the bottom left.
///
/// Board frame: origin at the bottom-left corner of the bottom-left tag's black border, x right, y DOWN, z
/// into the board, so that the tags' orientation is the identity. Kalibr's own target frame has the same
/// origin and x, with y up and z out of the board: p_kalibr = (x, -y, -z).
struct AprilGrid {
  int rows = 6;
  int columns = 6;
  double tag_size_m = 0.088;  ///< Outer edge of the black border.
  double tag_spacing =
      0.3;           ///< Width of the white lanes, and edge of the squares, over tag_size_m: in (0, 1].
  int first_id = 0;  ///< Kalibr's codeOffset.

  /// Throws Error(kInvalidInput) that names the field, its value and its range.
  void check() const;

  /// From one tag to the next.
  double pitch_m() const { return (1.0 + tag_spacing) * tag_size_m; }
  /// Everything printed, squares included, in the board frame.
  Eigen::AlignedBox2d printed_area_m() const;
  /// T_map_tag with the board frame ("board") as the map.
  TagMap map() const;
};

/// Reads Kalibr's target YAML: target_type: aprilgrid, tagRows, tagCols, tagSize, tagSpacing, codeOffset
/// (optional). Throws Error(kIo), Error(kInvalidInput) with file, line and key.
AprilGrid read_aprilgrid(const std::filesystem::path& path);

/// The ideal picture of a whole grid, its corner squares included.
class AprilGridPicture {
 public:
  explicit AprilGridPicture(const AprilGrid& grid);

  /// 0 = black, 1 = white, at a point of the board plane, in the board frame; white paper beyond the print.
  double brightness(double x_m, double y_m) const;
  const AprilGrid& grid() const { return grid_; }

 private:
  AprilGrid grid_;
  std::vector<TagPattern> patterns_;  ///< By row, then column.
};

}  // namespace apriltrack
