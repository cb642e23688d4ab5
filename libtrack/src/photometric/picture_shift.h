#pragma once

#include <vector>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// now(x, y) is what before(x + dx, y + dy) was.
struct PictureShift {
  int dx = 0, dy = 0;
  double correlation = -1.0;  ///< Of what the two have in common.
};

/// Of all shifts that leave two small pictures enough in common, that which correlates them best.
class PictureShifts {
 public:
  /// What both pictures show, at least, of either.
  explicit PictureShifts(double least_common_share) : least_common_share_(least_common_share) {}

  /// Of the same size. NaN counts as the picture's mean.
  PictureShift best(const Image<float>& before, const Image<float>& now);

 private:
  /// A picture without its mean, with what sums over any box of it take.
  struct Prepared {
    Image<float> light;
    std::vector<double> sums, squares;  ///< Of all rows above and columns to the left; a row and column more.

    void prepare(const Image<float>& picture);
    double total(const std::vector<double>& of, int x0, int y0, int x1, int y1) const;
  };
  double correlation(int dx, int dy) const;

  double least_common_share_;
  Prepared before_, now_;
};

}  // namespace apriltrack
