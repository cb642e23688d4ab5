#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apriltrack/camera/camera_formats.h"
#include "loss_words.h"

namespace apriltrack::app {
namespace {

/// By the key that states the place: Kalibr's and OpenVINS's, ORB-SLAM's, else mrcal's.
std::string words_of_place(const std::string& key) {
  if (key == "T_cn_cnm1") return "its place relative to the camera before (T_cn_cnm1)";
  if (key.starts_with("Stereo.")) return fmt::format("its place relative to cam0 ({})", key);
  return key.find("imu") != std::string::npos
             ? fmt::format("its {} (place or clock relative to the IMU)", key)
             : fmt::format("its place in the reference frame ({})", key);
}

std::string words_of_camera_fact(const ConversionLoss& loss) {
  switch (loss.kind) {
    case LossKind::kResolution:
      return "its resolution, " + loss.value;
    case LossKind::kResponse:
      return loss.value == "auto" ? "that its response is to be estimated (auto)"
                                  : "its response, " + loss.value;
    case LossKind::kExposure:
      return fmt::format("its exposure, {} s", loss.numbers.at(0));
    case LossKind::kLineDelay:
      return fmt::format("its line delay, {} s per row", loss.numbers.at(0));
    case LossKind::kNames:
      return fmt::format("its name (it is read back as {})", loss.value);
    default:
      return words_of_place(loss.value);
  }
}

}  // namespace

std::string sentence_of_camera_loss(const ConversionLoss& loss, const ConversionStep& step) {
  if (const std::string sentence = sentence_of_moved_points(loss); !sentence.empty()) return sentence;
  if (loss.kind == LossKind::kFurtherCameras)
    return fmt::format("not kept: the rig's further cameras: '{}'", fmt::join(loss.which, "', '"));
  if (loss.kind == LossKind::kUnreadLens)
    return fmt::format(
        "camera '{}': its lens is written as radtan with {} coefficients, which AprilTrack reads and Kalibr "
        "itself does not: it takes {}, k1 k2 p1 p2",
        loss.which.at(0), loss.numbers.at(0), loss.numbers.at(1));
  const std::string fact =
      fmt::format("not kept: camera '{}': {}", loss.which.at(0), words_of_camera_fact(loss));
  return step.stage == ConversionStep::Stage::kRead
             ? fact
             : fmt::format("{} (no place for it in {})", fact, step.title);
}

}  // namespace apriltrack::app
