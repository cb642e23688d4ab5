#include "loss_words.h"

#include <nlohmann/json.hpp>

#include "apriltrack/camera/camera_formats.h"

namespace apriltrack::app {
namespace {

/// The result may differ from what its user expects. A camera's files are small, and each of its numbers
/// counts.
bool is_warning(const ConversionLoss& loss) {
  return loss.how == LossHow::kAssumed || loss.how == LossHow::kUnknown ||
         subject_of(loss.kind) == LossSubject::kCamera;
}

}  // namespace

std::string sentence_of(const ConversionLoss& loss, const ConversionStep& step) {
  switch (subject_of(loss.kind)) {
    case LossSubject::kMap:
      return sentence_of_map_loss(loss, step);
    case LossSubject::kCamera:
      return sentence_of_camera_loss(loss, step);
    case LossSubject::kTrajectory:
      break;
  }
  return sentence_of_trajectory_loss(loss, step);
}

nlohmann::json report_losses(const std::vector<ConversionLoss>& losses, const ConversionStep& step,
                             const Console& console) {
  nlohmann::json all = nlohmann::json::array();
  for (const ConversionLoss& loss : losses) {
    const std::string sentence = sentence_of(loss, step);
    const bool was_logged = !sentence_of_moved_points(loss).empty();  // by the reader
    if (!was_logged && is_warning(loss))
      console.warning(step.file + ": " + sentence);
    else if (!was_logged)
      console.info(step.file + ": " + sentence);
    all.push_back({{"kind", to_string(loss.kind)},
                   {"how", to_string(loss.how)},
                   {"stage", step.stage == ConversionStep::Stage::kRead ? "read" : "write"},
                   {"which", loss.which},
                   {"value", loss.value},
                   {"numbers", loss.numbers},
                   {"message", sentence}});
  }
  return all;
}

void append(nlohmann::json& list, const nlohmann::json& more) {
  list.insert(list.end(), more.begin(), more.end());
}

}  // namespace apriltrack::app
