#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "apriltrack/io/lower_case.h"

namespace apriltrack {

/// An ending that the names of a format's files have, in small or capital letters.
struct NameEnding {
  std::string_view ending;  ///< ".fmap", "kitti.txt".
  bool chooses = false;     ///< A file to write whose name ends so is of this format, without another word.
  bool is_common = false;   ///< Other programs' files end so, too: it is never one format's alone.

  bool is_of(std::string_view name) const { return lower_case(name).ends_with(ending); }
};

/// The format of a table whose ending a name has, and which that chooses.
template <class Infos>
auto format_of_ending(const Infos& infos, const std::filesystem::path& path)
    -> std::optional<decltype(infos.begin()->format)> {
  const std::string name = path.filename().string();
  for (const auto& info : infos) {
    for (const NameEnding& one : info.endings)
      if (one.chooses && one.is_of(name)) return info.format;
  }
  return std::nullopt;
}

}  // namespace apriltrack
