#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/sensor_window.h"
#include "apriltrack/camera/skew.h"
#include "apriltrack/source/bag_input.h"
#include "bag_topics.h"
#include "picture_message.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostLookedAt = 9;
constexpr std::uint32_t kMostPixelsPerSide = 100'000;

/// Some of the topic's messages, evenly spread; those that cannot be read are left out.
std::vector<RosCameraInfo> sample_infos(BagReader& bag, std::size_t topic) {
  bag.choose({topic});
  const std::size_t count = bag.num_messages(), num_looked_at = std::min(kMostLookedAt, count);
  std::vector<RosCameraInfo> infos;
  std::size_t position = 0;
  for (std::size_t i = 0; i < num_looked_at; ++i) {
    const std::size_t wanted = num_looked_at == 1 ? 0 : i * (count - 1) / (num_looked_at - 1);
    for (; position < wanted; ++position) bag.pass_over();
    const auto message = bag.next();
    ++position;
    if (!message || !message->error.empty()) continue;
    try {
      infos.push_back(read_camera_message(bag.topics()[topic], message->bytes));
    } catch (const BadMessage&) {
      continue;
    }
  }
  return infos;
}

Distortion lens_of(const RosCameraInfo& info, const std::string& where) {
  std::vector<double> d = info.d;
  const std::string& model = info.distortion_model;
  if (std::ranges::any_of(d, [](double value) { return !std::isfinite(value); }))
    throw invalid_input(where, "D holds a number that is not finite");
  if (d.empty()) return NoDistortion();
  // kannala_brandt: Foxglove's word for it, which our own MCAP files have.
  if (model == "equidistant" || model == "fisheye" || model == "kannala_brandt") {
    if (d.size() != 4)
      throw invalid_input(where, fmt::format("{} takes 4 coefficients (D has {})", model, d.size()));
    return EquidistantDistortion(d);
  }
  if (model != "plumb_bob" && model != "rational_polynomial" && model != "radtan")
    throw invalid_input(where,
                        fmt::format("distortion_model '{}' is not supported; supported are plumb_bob, "
                                    "rational_polynomial, equidistant, fisheye and kannala_brandt: give "
                                    "--camera FILE",
                                    model));
  constexpr std::size_t kMost = 8;  // thin prisms and tilted sensors follow
  if (d.size() > kMost && std::all_of(d.begin() + kMost, d.end(), [](double value) { return value == 0.0; }))
    d.resize(kMost);
  if (d.size() != 4 && d.size() != 5 && d.size() != kMost)
    throw invalid_input(
        where, fmt::format("{} takes 4, 5 or 8 coefficients that are not zero (D has {})", model, d.size()));
  return RadtanDistortion(d);
}

bool is_uncalibrated(const std::vector<double>& matrix) {
  return std::ranges::all_of(matrix, [](double value) { return value == 0.0; });
}

void check_numbers(const RosCameraInfo& info, const std::vector<double>& matrix, const std::string& where) {
  for (const double value : matrix)
    if (!std::isfinite(value)) throw invalid_input(where, "its matrix holds a number that is not finite");
  if (!(matrix[0] > 0.0 && matrix[4] > 0.0))
    throw invalid_input(
        where, fmt::format("focal lengths must be > 0 pixels (are {} and {})", matrix[0], matrix[4]));
  if (matrix[3] != 0.0 || matrix[6] != 0.0 || matrix[7] != 0.0 || matrix[8] != 1.0)
    throw invalid_input(
        where, fmt::format("its matrix must be fx skew cx, 0 fy cy, 0 0 1 (is {})", fmt::join(matrix, " ")));
  if (info.width > kMostPixelsPerSide || info.height > kMostPixelsPerSide)
    throw invalid_input(where, fmt::format("claims {} x {} pixels", info.width, info.height));
  for (const std::uint32_t number :
       {info.roi_x, info.roi_y, info.roi_width, info.roi_height, info.binning_x, info.binning_y})
    if (number > kMostPixelsPerSide)
      throw invalid_input(where, fmt::format("its roi or binning is {} pixels", number));
}

/// camera: of the whole sensor, as the matrix is.
void check_skew(double skew_px, const Camera& camera, const std::string& where, const LogSink& log) {
  if (skew_px == 0.0) return;
  const std::string text = fmt::format("a skew of {} pixels moves points of the picture by up to {:.2f} px",
                                       skew_px, largest_skew_effect_px(skew_px, camera));
  constexpr const char* kWayOut = "calibrate without skew (cameracalibrator --fisheye-fix-skew)";
  if (largest_skew_effect_px(skew_px, camera) > kMaxSkewEffect_px)
    throw invalid_input(where, fmt::format("{}, and is not supported (without it, up to {} px pass); {}",
                                           text, kMaxSkewEffect_px, kWayOut));
  log(LogLevel::kWarning, fmt::format("{}: {}, and is passed over; {}", where, text, kWayOut));
}

/// By the matrix, 3 x 3, of the pictures that are published.
Camera camera_of(const RosCameraInfo& info, const std::vector<double>& k, const Distortion& lens,
                 const std::string& where, const LogSink& log) {
  const Camera whole{.name = "cam0",
                     .model = CameraModel({k[0], k[4], k[2], k[5]}, lens),
                     .width = static_cast<int>(info.width),
                     .height = static_cast<int>(info.height),
                     .response_origin = ResponseOrigin::kAssumed};
  check_skew(k[1], whole, where, log);
  const auto joined = [](std::uint32_t binning) { return std::max(1, static_cast<int>(binning)); };
  return camera_of_window(whole, {.x_offset = static_cast<int>(info.roi_x),
                                  .y_offset = static_cast<int>(info.roi_y),
                                  .width = static_cast<int>(info.roi_width),
                                  .height = static_cast<int>(info.roi_height),
                                  .binning_x = joined(info.binning_x),
                                  .binning_y = joined(info.binning_y)});
}

}  // namespace

std::vector<std::string> bag_camera_topics(const std::string& input) {
  const auto bag = open_bag(input);
  std::vector<std::string> names;
  for (const BagTopic& topic : bag->topics())
    if (topic.count > 0 && is_camera_type(topic.type)) names.push_back(topic.name);
  return names;
}

std::optional<Camera> bag_camera(const std::string& input, const std::string& topic, const LogSink& log) {
  const auto bag = open_bag(input);
  const BagTopic images = bag->topics()[choose_image_topic(*bag, input, topic)];
  const auto info_topic = camera_info_topic(*bag, images);
  if (!info_topic || !is_read_topic(bag->topics()[*info_topic])) return std::nullopt;
  std::vector<RosCameraInfo> infos = sample_infos(*bag, *info_topic);
  if (infos.empty()) return std::nullopt;
  // A driver may start before it has read its calibration.
  const auto was_calibrated = [](const RosCameraInfo& info) { return !is_uncalibrated(info.k); };
  if (std::ranges::any_of(infos, was_calibrated)) std::erase_if(infos, std::not_fn(was_calibrated));
  const std::string where = fmt::format("{} {}", input, bag->topics()[*info_topic].name);
  const auto odd =
      std::ranges::find_if(infos, [&](const RosCameraInfo& info) { return info != infos.front(); });
  if (odd != infos.end())
    log(LogLevel::kWarning,
        fmt::format("{}: the camera's description changes within the bag; the first one is "
                    "used: give --camera FILE if another one holds",
                    where));
  const RosCameraInfo& info = infos.front();
  const std::vector<double> rectified = {info.p[0], info.p[1], info.p[2], info.p[4], info.p[5],
                                         info.p[6], info.p[8], info.p[9], info.p[10]};
  const std::vector<double>& matrix = is_rectified(images) ? rectified : info.k;
  if (is_uncalibrated(info.k) || matrix[0] == 0.0) {
    log(LogLevel::kWarning, fmt::format("{}: the camera was not calibrated ({} is zero)", where,
                                        is_rectified(images) ? "P" : "K"));
    return std::nullopt;
  }
  check_numbers(info, matrix, where);
  return camera_of(info, matrix, is_rectified(images) ? Distortion(NoDistortion()) : lens_of(info, where),
                   where, log);
}

}  // namespace apriltrack
