#pragma once

#include <string_view>

#include "apriltrack/report/colour.h"
#include "apriltrack/report/svg_picture.h"

namespace apriltrack {

/// The variable of the page's style that holds an ink's colour: "--ink".
std::string_view ink_variable(SvgInk ink);

/// The ink of a colour of the palette (colour.h), black being the page's own. Requires that it is one, and
/// not yellow, which cannot be seen on white.
SvgInk ink_of(const Colour& colour);

/// About the width of letters, in their size: fonts differ.
double svg_width_of(std::string_view words, double letter_size);

}  // namespace apriltrack
