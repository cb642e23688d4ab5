#include <fmt/format.h>

#include "loss_words.h"

namespace apriltrack::app {
namespace {

std::string words_of_times(const ConversionLoss& loss, std::string_view title) {
  if (loss.how == LossHow::kConverted)
    return fmt::format("a {} has no times: they are in {}", title, loss.value);
  return fmt::format("the times are those of {}: a {} has none", loss.value, title);
}

std::string words_of_velocities(const ConversionLoss& loss, std::string_view title) {
  if (loss.how == LossHow::kAssumed)
    return fmt::format(
        "a {} wants velocities, which are not known: they are the differences of the positions "
        "before and after",
        title);
  return "the velocities are left out: a trajectory has poses alone";
}

std::string words_of_biases(const ConversionLoss& loss, std::string_view title) {
  if (loss.how == LossHow::kAssumed)
    return fmt::format("a {} wants the biases of an IMU, and there is none: they are 0", title);
  return "the biases of the IMU are left out: a trajectory has poses alone";
}

}  // namespace

std::string sentence_of_trajectory_loss(const ConversionLoss& loss, const ConversionStep& step) {
  switch (loss.kind) {
    case LossKind::kTimes:
      return words_of_times(loss, step.title);
    case LossKind::kVelocities:
      return words_of_velocities(loss, step.title);
    case LossKind::kBiases:
      return words_of_biases(loss, step.title);
    default:
      return "";
  }
}

}  // namespace apriltrack::app
