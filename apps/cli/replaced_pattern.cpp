#include "replaced_pattern.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "kept_files.h"

namespace apriltrack::app {

std::optional<std::string> told_of_replaced_pattern(const std::vector<std::string>& words,
                                                    std::size_t least) {
  namespace fs = std::filesystem;
  if (words.empty() || words.size() < least) return std::nullopt;
  const fs::path first = words.front();
  const bool are_pictures_of_one_folder = std::ranges::all_of(words, [&](const std::string& word) {
    std::error_code ignored;
    return has_picture_ending(word) && fs::path(word).parent_path() == first.parent_path() &&
           fs::is_regular_file(word, ignored);
  });
  if (!are_pictures_of_one_folder) return std::nullopt;
  const fs::path pattern = first.parent_path() / ("*" + first.extension().string());
  return fmt::format(
      "for the pictures of a folder quote the pattern, '{}', which a shell replaces by their names "
      "otherwise; or name the folder, {}",
      pattern.string(), first.has_parent_path() ? first.parent_path().string() : ".");
}

}  // namespace apriltrack::app
