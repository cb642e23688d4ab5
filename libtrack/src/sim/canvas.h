#pragma once

#include <Eigen/Core>

#include "apriltrack/base/random.h"
#include "apriltrack/image/image.h"

namespace apriltrack {

/// A wall to paint on: metres from its lower left corner, right and up; values are reflectances.
class Canvas {
 public:
  Canvas(double width_m, double height_m, double texel_m, float reflectance);

  double width_m() const { return width_m_; }
  double height_m() const { return height_m_; }

  void rectangle(double x, double y, double width, double height, double reflectance);
  void disc(double x, double y, double radius, double reflectance);
  /// Lines of words: short bars of uneven length.
  void text(double x, double y, double width, double height, double line_m, double reflectance,
            RandomStream& random);
  void stripes(double x, double y, double width, double height, double period_m, bool is_upright,
               double reflectance);
  /// Blocks of black and white that look like a tag and decode as none: the border is broken on two sides.
  void false_tag(double x, double y, double size, RandomStream& random);
  /// Fine grain on everything painted so far, as a share of the reflectance.
  void grain(double share, RandomStream& random);

  /// At the nearest texel.
  float at(double x, double y) const;

 private:
  int texel(double metres) const;

  double width_m_;
  double height_m_;
  double texel_m_;
  Image<float> picture_;
};

}  // namespace apriltrack
