#pragma once

#include <string>
#include <vector>

#include "foreign_map.h"

namespace apriltrack {

/// Whether a body of TagSLAM of this `type` is a grid of tags.
bool is_tagslam_board(const std::string& type);

/// The tags of such a body, T_body_tag. board: the body's mapping that is called as its type. Adds keys that
/// are passed over to `foreign`. Throws Error(kInvalidInput) with file, line and key.
std::vector<ForeignTag> tags_of_tagslam_board(const std::string& type, const YamlNode& board,
                                              std::vector<std::string>& foreign);

}  // namespace apriltrack
