#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "apriltrack/report/svg_picture.h"

namespace apriltrack::test {

/// An element of a drawing, with the style of the group that it is in.
struct SvgElement {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::string style;

  /// Of an attribute; NaN where there is none.
  double number(const std::string& attribute) const;
  /// All pairs of numbers in an attribute: "1,2 3,4" and "M1 2h0M3 4h0" are (1, 2) and (3, 4).
  std::vector<Eigen::Vector2d> points(const std::string& attribute) const;
};

/// In their order, groups left out.
std::vector<SvgElement> svg_elements(const SvgPicture& picture);

}  // namespace apriltrack::test
