#pragma once

#include <filesystem>
#include <string>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// One tag on a sheet of A4 paper held upright, 210 mm x 297 mm.
struct PrintPage {
  std::string family;
  int id = 0;
  /// total_width x total_width cells, row 0 on top: 0 black, 1 white, NaN where nothing is printed.
  Image<float> cells;
  int width_at_border = 0;  ///< Cells across the square whose edge is the tag's size.
  double size_m = 0.0;      ///< Edge of that square.
  /// The square is white within black, so that what lies outside it is black too and the caption says so.
  bool has_reversed_border = false;
};

/// The page as SVG 1.1 in millimetres: the tag in the middle of the part above the foot, in the foot a
/// caption with family, id and size, and a ruler of 100 mm to check the printer's scale with. Requires square
/// cells. Throws Error(kInvalidInput) that names the tag and the largest size that fits when the tag does not
/// fit the paper.
std::string print_page_svg(const PrintPage& page);

/// Writes that text. Throws what print_page_svg throws, and Error(kIo).
void write_print_page(const std::filesystem::path& path, const PrintPage& page);

}  // namespace apriltrack
