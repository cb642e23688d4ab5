#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/eval/trajectory_formats.h"
#include "console.h"

namespace apriltrack::app {

/// One sentence. title: of the format that is read or written, "EuRoC trajectory (.csv)".
std::string sentence_of(const TrajectoryLoss& loss, std::string_view title);

/// {"kind", "how", "message"} each.
nlohmann::json losses_json(const std::vector<TrajectoryLoss>& losses, std::string_view title);

/// What nobody stated is a warning, all else talk. file: what each line begins with.
void tell_losses(const std::vector<TrajectoryLoss>& losses, std::string_view title, const std::string& file,
                 const Console& console);

}  // namespace apriltrack::app
