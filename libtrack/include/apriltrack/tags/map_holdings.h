#pragma once

#include <string_view>
#include <vector>

#include "apriltrack/io/conversion_loss.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// What a format of tag layouts holds of each tag beside its pose.
struct MapHoldings {
  bool sizes = false, families = false, covariances = false, frame_name = false;
};

/// Adds what a format with these holdings leaves out of the map. own_extension: an `x_...` key that it does
/// hold.
void add_left_out(const TagMap& map, MapHoldings holdings, std::vector<ConversionLoss>& losses,
                  std::string_view own_extension = {});

}  // namespace apriltrack
