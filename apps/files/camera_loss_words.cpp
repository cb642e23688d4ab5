#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "apriltrack/camera/camera_formats.h"
#include "loss_words.h"

namespace apriltrack::app {
namespace {

/// What a key that states a place, or a clock, puts the camera in relation to.
struct PlaceKey {
  std::string_view key;
  std::string_view words;
};
constexpr std::string_view kToImu = "place relative to the IMU";
constexpr std::string_view kToOther = "place relative to the other camera";
constexpr PlaceKey kPlaceKeys[] = {
    {"T_cn_cnm1", "place relative to the camera before"},
    {"T_cam_imu", kToImu},  // Kalibr
    {"timeshift_cam_imu", "clock relative to the IMU"},
    {"T_imu_cam", kToImu},  // OpenVINS, Basalt
    {"cam_time_offset_ns", "clock relative to the IMU"},
    {"T_BS", "place on the body"},  // EuRoC
    {"IMU.T_b_c1", kToImu},         // ORB-SLAM, as the next
    {"Tbc", kToImu},
    {"Stereo.T_c1_c2", kToOther},
    {"Tlr", kToOther},
    {"Stereo.b", kToOther},
    {"Camera.bf", kToOther},
    {"transform_matrix", "places at the frames"},  // nerfstudio
};

/// A key that is not in the list is mrcal's, with its numbers.
std::string words_of_place(const ConversionLoss& loss) {
  if (loss.numbers.size() == 2)
    return fmt::format("its place on a stereo rig ({}: {:.6g} m right of the other camera, {:.6g} m below)",
                       loss.value, loss.numbers[0], loss.numbers[1]);
  const auto* found = std::ranges::find(kPlaceKeys, loss.value, &PlaceKey::key);
  return fmt::format("its {} ({})",
                     found == std::end(kPlaceKeys) ? "place in the reference frame" : found->words,
                     loss.value);
}

std::string words_of_camera_fact(const ConversionLoss& loss, ConversionStep::Stage stage) {
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
      return fmt::format("its name (it is {} {})",
                         stage == ConversionStep::Stage::kRead ? "called" : "read back as", loss.value);
    case LossKind::kExtrinsics:
      return words_of_place(loss);
    case LossKind::kRectification:
      return fmt::format("how its pictures are rectified ({})", loss.value);
    case LossKind::kCameraKeys:
      return fmt::format("keys that are not for AprilTrack: {}", loss.value);
    default:
      return "";
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
  const std::string words = words_of_camera_fact(loss, step.stage);
  if (words.empty()) return "";
  const std::string fact = fmt::format("not kept: camera '{}': {}", loss.which.at(0), words);
  return step.stage == ConversionStep::Stage::kRead
             ? fact
             : fmt::format("{} (no place for it in {})", fact, step.title);
}

}  // namespace apriltrack::app
