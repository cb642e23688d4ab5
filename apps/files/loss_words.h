#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/io/conversion_loss.h"
#include "cli/console.h"

namespace apriltrack::app {

/// Half of a conversion: what the file that is read does not say, or the one that is written does not hold.
struct ConversionStep {
  enum class Stage { kRead, kWrite };
  Stage stage = Stage::kRead;
  std::string_view title;  ///< Of the format: "field map of Limelight (.fmap)".
  std::string file;
};

/// One sentence.
std::string sentence_of(const ConversionLoss& loss, const ConversionStep& step);

/// Of a map, a camera, a trajectory; as sentence_of().
std::string sentence_of_map_loss(const ConversionLoss& loss, const ConversionStep& step);
std::string sentence_of_camera_loss(const ConversionLoss& loss, const ConversionStep& step);
std::string sentence_of_trajectory_loss(const ConversionLoss& loss, const ConversionStep& step);

/// Reports each on stderr: what nobody stated, and all of a camera, as a warning. Returns them for machines:
/// a list of {"kind", "how", "stage", "which", "value", "numbers", "message"}.
nlohmann::json report_losses(const std::vector<ConversionLoss>& losses, const ConversionStep& step,
                             const Console& console);
/// Adds the entries of one list to another.
void append(nlohmann::json& list, const nlohmann::json& more);

}  // namespace apriltrack::app
