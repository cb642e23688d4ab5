#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// The printed picture of one tag in linear light: 0 = black, 1 = white, per cell.
///
/// The tag plane is measured in half tag sizes: u right, v down, [-1, 1] x [-1, 1] is the square whose
/// corners the detector reports. Families of the "standard" and "circle" kinds have data cells outside that
/// square.
class TagPattern {
 public:
  /// cells: total_width x total_width, row 0 on top; 0 black, 1 white, NaN where the family prints nothing
  /// (corners of circle families, middle of tagCustom48h12): treated as white paper.
  TagPattern(Image<float> cells, int width_at_border);

  /// Brightness at (u, v); white paper outside the cells.
  double brightness(double u, double v) const;
  /// Edge of one cell in units of u: 2 / width_at_border.
  double cell_size() const { return 2.0 / width_at_border_; }
  /// Half the width of the printed cells in units of u: total_width / width_at_border.
  double half_extent() const;
  /// total_width x total_width cells.
  const Image<float>& cells() const { return cells_; }
  int width_at_border() const { return width_at_border_; }

 private:
  Image<float> cells_;
  int width_at_border_;
};

/// A family of tags: which codes there are and how they are printed. Families live as long as the program.
class TagFamily {
 public:
  /// Throws Error(kInvalidInput) that lists the known names. Built on first use; threads may call it at once.
  static const TagFamily& get(std::string_view name);
  /// Every family of AprilTag 3.3, and tag36h11b2: 36h11 with the two-cell border of Kalibr's printed grids.
  static std::span<const std::string_view> names();
  static bool is_known(std::string_view name);

  const std::string& name() const { return name_; }
  int num_codes() const { return num_codes_; }
  /// Of each code.
  int num_bits() const { return static_cast<int>(bit_cells_.size()); }
  /// Cells across the square whose corners the detector reports.
  int width_at_border() const { return width_at_border_; }
  /// Cells across the whole printed tag.
  int total_width() const { return total_width_; }
  /// A white ring inside a black one, instead of black on white paper ("standard", "circle" and "custom"
  /// kinds).
  bool has_reversed_border() const { return has_reversed_border_; }
  /// Bits that the detector corrects: 2, but 1 for families of over 5,000 codes, whose tables would take
  /// gigabytes.
  int max_corrected_bits() const { return max_corrected_bits_; }
  /// Probability that bits thrown like coins read as one of the codes, in one of four turns, with at most so
  /// many of them corrected: 4 * codes * sum_{k <= corrected} C(bits, k) / 2^bits.
  double chance_of_reading(int corrected_bits) const;

  /// id in [0, num_codes()).
  TagPattern pattern(int id) const;

 private:
  friend class TagFamilyTable;
  TagFamily() = default;

  std::string name_;
  int num_codes_ = 0;
  int width_at_border_ = 0;
  int total_width_ = 0;
  bool has_reversed_border_ = false;
  int max_corrected_bits_ = 2;
  /// Data bits of each id, the first of bit_cells_ most significant.
  std::vector<std::uint64_t> codes_;
  /// Column and row of each data bit, counted from the corner of the detected square: those outside are
  /// negative or beyond its width.
  std::vector<Eigen::Vector2i> bit_cells_;
};

}  // namespace apriltrack
