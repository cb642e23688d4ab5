#pragma once

#include <filesystem>

#include "apriltrack/export/export_map.h"

namespace apriltrack {

// One for each format.

std::string gltf_text(const TagMap& map);
std::string glb_bytes(const TagMap& map);
std::string urdf_text(const TagMap& map);
std::string sdf_text(const TagMap& map);
std::vector<ExportedFile> colmap_files(const TagMap& map);
/// Throws Error(kInvalidInput) where the folder has a COLMAP model that colmap_files() did not make.
void check_colmap_folder(const std::filesystem::path& folder);
/// left_out: gets the tags whose covariance is neither 0 nor has an inverse: no edge tells it.
std::string g2o_text(const TagMap& map, std::vector<std::string>& left_out);
std::string corners_csv(const TagMap& map);
std::string corners_json(const TagMap& map);

}  // namespace apriltrack
