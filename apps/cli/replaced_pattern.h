#pragma once

#include <optional>
#include <string>
#include <vector>

namespace apriltrack::app {

/// What to do where words of the command line are pictures of one folder, as when a shell has put names in
/// place of a pattern that was not quoted; nullopt where they are not, or there are fewer than `least`.
std::optional<std::string> told_of_replaced_pattern(const std::vector<std::string>& words, std::size_t least);

}  // namespace apriltrack::app
