#pragma once

#include <map>
#include <string>
#include <vector>

#include "foreign_map.h"

namespace apriltrack {

/// Tags that another project keeps together: a bundle, a body.
struct TagBundle {
  std::string name;
  std::vector<ForeignTag> tags;
};

/// The bundle called options.bundle, or the only one of at least one; others are told as left out. Throws
/// Error(kInvalidInput) that lists the names when there are several and none is chosen, or the chosen one is
/// not there. word: "bundle".
TagBundle chosen_bundle(const std::vector<TagBundle>& bundles, const MapReadOptions& options,
                        const std::string& file, const std::string& word,
                        std::vector<ConversionLoss>& losses);

}  // namespace apriltrack
