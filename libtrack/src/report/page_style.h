#pragma once

#include <string_view>

namespace apriltrack {

/// The style sheet of all pages. Colours are variables, of which svg_inks.h names those of drawings.
std::string_view page_style();

}  // namespace apriltrack
