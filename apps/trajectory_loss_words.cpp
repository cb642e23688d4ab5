#include "trajectory_loss_words.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace apriltrack::app {
namespace {

std::string words_of_times(const TrajectoryLoss& loss, std::string_view title) {
  if (loss.how == TrajectoryLossHow::kConverted)
    return fmt::format("a {} has no times: they are in {}", title, loss.value);
  return fmt::format("the times are those of {}: a {} has none", loss.value, title);
}

std::string words_of_velocities(const TrajectoryLoss& loss, std::string_view title) {
  if (loss.how == TrajectoryLossHow::kAssumed)
    return fmt::format(
        "a {} wants velocities, which are not known: they are the differences of the positions "
        "before and after",
        title);
  return "the velocities are left out: a trajectory has poses alone";
}

std::string words_of_biases(const TrajectoryLoss& loss, std::string_view title) {
  if (loss.how == TrajectoryLossHow::kAssumed)
    return fmt::format("a {} wants the biases of an IMU, and there is none: they are 0", title);
  return "the biases of the IMU are left out: a trajectory has poses alone";
}

}  // namespace

std::string sentence_of(const TrajectoryLoss& loss, std::string_view title) {
  switch (loss.kind) {
    case TrajectoryLossKind::kTimes:
      return words_of_times(loss, title);
    case TrajectoryLossKind::kVelocities:
      return words_of_velocities(loss, title);
    case TrajectoryLossKind::kBiases:
      return words_of_biases(loss, title);
  }
  return "";
}

nlohmann::json losses_json(const std::vector<TrajectoryLoss>& losses, std::string_view title) {
  nlohmann::json all = nlohmann::json::array();
  for (const TrajectoryLoss& loss : losses)
    all.push_back({{"kind", to_string(loss.kind)},
                   {"how", to_string(loss.how)},
                   {"message", sentence_of(loss, title)}});
  return all;
}

void tell_losses(const std::vector<TrajectoryLoss>& losses, std::string_view title, const std::string& file,
                 const Console& console) {
  for (const TrajectoryLoss& loss : losses) {
    const std::string text = file + ": " + sentence_of(loss, title);
    if (loss.how == TrajectoryLossHow::kAssumed)
      console.warning(text);
    else
      console.info(text);
  }
}

}  // namespace apriltrack::app
