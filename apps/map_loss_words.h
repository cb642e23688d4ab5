#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/tags/map_loss.h"
#include "console.h"

namespace apriltrack::app {

/// Whether a file did not say, or does not hold.
enum class LossStage { kRead, kWrite };

/// One sentence. title: of the format, "field map of Limelight (.fmap)".
std::string sentence_of(const MapLoss& loss, LossStage stage, std::string_view title);

/// {"kind", "how", "stage", "tags", "message"} each.
nlohmann::json losses_json(const std::vector<MapLoss>& losses, LossStage stage, std::string_view title);

/// What nobody stated is a warning, all else talk. file: what each line begins with.
void tell_losses(const std::vector<MapLoss>& losses, LossStage stage, std::string_view title,
                 const std::string& file, const Console& console);

}  // namespace apriltrack::app
