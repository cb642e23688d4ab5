#pragma once

#include <string>
#include <vector>

#include "tag_places.h"

namespace apriltrack {

/// "0.09 m and 3.0 degrees".
std::string shift_and_turn(const Pose& change);

// What is wrong with the tag `name`, by how much, and what to do.

std::string words_of_size(const TagFit& scaled, const std::string& name);
std::string words_of_bend(const TagFit& bent, const std::string& name);
/// begin: of the recording.
std::string words_of_move(const TwoPlaces& two, const std::vector<ProbeView>& probes, Timestamp begin,
                          const std::string& name);
std::string words_of_copies(const TwoPlaces& two, const std::string& name);
std::string words_of_loose(const std::string& name);
/// What is said of a tag, where another may be at fault in its place; once.
std::string words_of_rival(const std::string& words);
/// Where another may be that stays in the map, or one of several: tags, or boards of them.
std::string words_of_rivals_in_map(const std::string& words, const std::vector<std::vector<TagKey>>& others);
/// Where another may be, or one of several, and there is no map.
std::string words_of_rivals_instead(const std::string& words, const std::vector<std::vector<TagKey>>& others);
/// Of the only tag that joins the two places at which another was found, or one of the board that does.
std::string words_of_joint(const std::string& name, const std::vector<TagKey>& board,
                           const std::string& of_two_places);

}  // namespace apriltrack
