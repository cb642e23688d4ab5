#include "messages/systematic_messages.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>

#include "observations/observations.h"

namespace apriltrack {
namespace {

std::string message_of(const TimeError& error) {
  const double value_ms = 1e3 * error.value_s, sigma_ms = 1e3 * error.sigma_s;
  constexpr std::string_view kWhatFollows =
      "Sound tags may be accused for it. The covariances count it, and the map is not refined on pictures";
  if (error.kind == TimeError::Kind::kReadout)
    return fmt::format(
        "{}: the rows of a picture look as if they were taken one after another, over {:.1f} ms from the {} "
        "(sigma {:.1f}): a rolling shutter, which bends what moves. Film anew, more slowly or standing still "
        "for each picture, or with a global shutter. {}",
        error.camera, std::abs(value_ms), value_ms > 0.0 ? "first to the last" : "last to the first",
        sigma_ms, kWhatFollows);
  return fmt::format(
      "{}: its pictures look as if they were taken {:.1f} ms (sigma {:.1f}) {} those of {} of the same time. "
      "Trigger the cameras together, or correct the times. {}",
      error.camera, std::abs(value_ms), sigma_ms, value_ms > 0.0 ? "after" : "before", error.first_camera,
      kWhatFollows);
}

std::string message_of(const PrintBatches& batches) {
  return fmt::format(
      "the tags look like two prints of different size: {} are {:.1f} % (sigma {:.2f}) larger, beside their "
      "stated sizes, than {}. Measure a tag of each, and state both: the map is by the sizes as "
      "stated, and its covariances count that either print may not be",
      list_tags(batches.larger), 100.0 * std::expm1(batches.log_ratio), 100.0 * batches.sigma,
      list_tags(batches.smaller));
}

std::string message_of_print_aspect(double print_aspect) {
  return fmt::format(
      "it may be the print, and not the lens: tags that are {:.1f} % {} look like a lens whose fy / fx is "
      "not the camera file's, and pixels are seldom so far from square. Measure a tag both ways: if it is, "
      "print anew, and keep the camera file as it is. The covariances count either",
      100.0 * std::abs(print_aspect), print_aspect > 0.0 ? "wider than high" : "higher than wide");
}

}  // namespace

CalibrationFinding reported(const TimeError& error) {
  const bool is_readout = error.kind == TimeError::Kind::kReadout;
  CalibrationFinding finding;
  finding.kind = is_readout ? CalibrationFinding::Kind::kReadout : CalibrationFinding::Kind::kDelay;
  finding.cameras = {error.camera};
  if (!is_readout) finding.cameras.push_back(error.first_camera);
  finding.value = error.value_s;
  finding.sigma = error.sigma_s;
  finding.unit = "s";
  finding.message = message_of(error);
  return finding;
}

CalibrationFinding reported(const PrintBatches& batches) {
  CalibrationFinding finding;
  finding.kind = CalibrationFinding::Kind::kSizeGroups;
  finding.tags = batches.larger;
  finding.alternatives = {batches.smaller};
  finding.value = std::exp(batches.log_ratio);
  finding.sigma = *finding.value * batches.sigma;
  finding.unit = "1";
  finding.message = message_of(batches);
  return finding;
}

CalibrationFinding reported_print_aspect(double print_aspect) {
  CalibrationFinding finding;
  finding.kind = CalibrationFinding::Kind::kPrintAnisotropy;
  finding.value = 1.0 + print_aspect;
  finding.unit = "1";
  finding.message = message_of_print_aspect(print_aspect);
  return finding;
}

}  // namespace apriltrack
