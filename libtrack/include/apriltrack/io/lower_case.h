#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace apriltrack {

/// Letters A to Z as a to z, whatever the locale.
inline std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

/// ".png" of "a/B.PNG".
inline std::string lower_case_ending(const std::filesystem::path& path) {
  return lower_case(path.extension().string());
}

}  // namespace apriltrack
