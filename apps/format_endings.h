#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "console.h"

namespace apriltrack::app {

/// Whose files have an ending. formats: as `--to` takes them.
struct FormatEnding {
  std::string_view ending;  ///< ".fmap"
  std::vector<std::string_view> formats;
};

std::span<const FormatEnding> map_endings();
std::span<const FormatEnding> camera_endings();
std::span<const FormatEnding> trajectory_endings();

/// Holds the name of an output against the format that an option asks for. An ending that is another format's
/// alone would mislead every reader: Error(kInvalidInput). One that several formats share, none of them this,
/// is warned of. option: "--to".
void check_ending(const std::string& output, std::string_view format, std::span<const FormatEnding> endings,
                  std::string_view option, const Console& console);

}  // namespace apriltrack::app
