#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// What another format of tag layouts cannot hold, or did not say.
enum class MapLossKind {
  kSizes,        ///< Of the tags.
  kFamilies,     ///< Of the tags.
  kCovariance,   ///< Of the tags' poses.
  kTags,         ///< Tags that are not in the result.
  kFrameName,    ///< Name of the map's frame.
  kOrigin,       ///< Where the origin lies: a field's corner, or its centre.
  kFieldSize,    ///< Length and width of a field.
  kMatrixOrder,  ///< Matrices that were written column by column.
  kProvenance,   ///< What made the map.
  kStatistics,   ///< Of the tags.
  kExtensions,   ///< `x_...` keys.
  kForeignKeys,  ///< Keys of the other format that a map has no place for.
};

/// What became of it.
enum class MapLossHow {
  kLeftOut,    ///< It was there, and is not in the result.
  kAssumed,    ///< It was not there, and the result has `value`, which nobody stated.
  kGiven,      ///< It was not there, and the result has what the caller gave.
  kConverted,  ///< It is in the result in another form, which `value` or `shift_m` tells.
  kUnknown,    ///< It was not there, and the result stays as it is.
};

/// One thing to know about a conversion. The words for it are the caller's.
struct MapLoss {
  MapLossKind kind = MapLossKind::kSizes;
  MapLossHow how = MapLossHow::kLeftOut;
  std::vector<TagKey> tags = {};  ///< Whose; empty: of all tags, or of the map itself.
  std::string value = {};         ///< A family, names of keys or of bundles, a frame; what `kind` asks for.
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();  ///< kOrigin: what was added to each position.
};

/// "sizes", "families", "covariance", "tags", "frame_name", "origin", "field_size", "matrix_order",
/// "provenance", "statistics", "extensions", "foreign_keys".
std::string_view to_string(MapLossKind kind);
/// "left_out", "assumed", "given", "converted", "unknown".
std::string_view to_string(MapLossHow how);

/// What a format holds of each tag beside its pose.
struct MapHoldings {
  bool sizes = false, families = false, covariances = false, frame_name = false;
};

/// Adds what a format with these holdings leaves out of the map. own_extension: an `x_...` key that it does
/// hold.
void add_left_out(const TagMap& map, MapHoldings holdings, std::vector<MapLoss>& losses,
                  std::string_view own_extension = {});

}  // namespace apriltrack
