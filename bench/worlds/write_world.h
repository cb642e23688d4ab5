#pragma once

#include <filesystem>

#include "world.h"

namespace apriltrack::worlds {

/// Writes what a user has (camera.yaml, tag_sizes.yaml, frames.csv where lamps flicker), the truth (map.yaml,
/// truth.tum, world.json) and renders frames/. One thread.
void write_world(const World& world, const std::filesystem::path& folder);

/// The same without frames, and without what belongs to them (frames.csv, truth.tum).
void write_without_pictures(const World& world, const std::filesystem::path& folder);

/// world.json: the seed, the kind, all that was drawn, the planted fault, the tags, and every view of them.
nlohmann::json describe(const World& world);

}  // namespace apriltrack::worlds
