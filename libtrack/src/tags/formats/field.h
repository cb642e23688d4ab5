#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foreign_map.h"

namespace apriltrack {

/// Frame of a layout whose origin is a field's corner (WPILib's: the right end of the blue alliance's wall),
/// and of one whose origin is the field's centre (Limelight's).
inline constexpr const char* kFieldFrame = "field";
inline constexpr const char* kFieldCentreFrame = "field_centre";

/// The `x_...` key in which a map keeps what sports fields have: {length_m, width_m, type}.
inline constexpr std::string_view kFieldExtension = "x_field";

/// What a map or a file knows of its field; each part may be missing.
struct FieldFacts {
  std::optional<FieldSize> size;
  std::string type;  ///< Limelight's: "frc", "ftc", ...
};

FieldFacts field_of(const TagMap& map);
/// Nothing is added where nothing is known.
void set_field(TagMap& map, const FieldFacts& field);

/// The file's own, else that of the options; complains where both are known and differ. Zeros count as not
/// known: WPILib's own converter writes them.
std::optional<FieldSize> agreed_field(const std::optional<FieldSize>& own, const MapPlace& place,
                                      const std::optional<FieldSize>& given);

/// From the centre to the corner.
Eigen::Vector3d centre_of(const FieldSize& field);

/// The map that formats with that origin hold, and what was done for it: `frame` is kFieldFrame or
/// kFieldCentreFrame. Where the field's size is not known, positions stay as they are, and that is told.
TagMap with_origin(const TagMap& map, const char* frame, const std::optional<FieldSize>& field,
                   std::vector<ConversionLoss>& losses);

}  // namespace apriltrack
