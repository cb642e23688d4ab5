#include "track_mcap.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "apriltrack/bag/mcap_writer.h"
#include "apriltrack/export/foxglove.h"
#include "apriltrack/export/ros_pose.h"
#include "apriltrack/source/encode_jpeg.h"
#include "mcap_scene.h"

namespace apriltrack::app {
namespace {

constexpr int kJpegQuality = 90;
constexpr double kPathEvery_s = 1.0;
constexpr const char* kStatusType = "apriltrack.FrameStatus";

/// Foxglove draws in frames by their names: the camera's must not be the map's.
std::string camera_frame(const Camera& camera, const TagMap& map) {
  return camera.name == map.frame ? camera.name + "_camera" : camera.name;
}

/// Numbers for the plot panel.
std::string status_schema() {
  const nlohmann::json number = {{"type", "number"}}, text = {{"type", "string"}};
  const nlohmann::json whole = {{"type", "integer"}};
  const nlohmann::json time = {
      {"type", "object"}, {"title", "time"}, {"properties", {{"sec", whole}, {"nsec", whole}}}};
  return nlohmann::json({{"title", kStatusType},
                         {"type", "object"},
                         {"properties",
                          {{"timestamp", time},
                           {"status", text},
                           {"reason", text},
                           {"tags_detected", whole},
                           {"tags_tracked", whole},
                           {"sigma_position_m", number},
                           {"sigma_rotation_rad", number},
                           {"second_mode_odds", number},
                           {"exposure_s", number},
                           {"latency_ms", number}}},
                         {"required", {"timestamp", "status"}}})
      .dump();
}

nlohmann::json status_of(Timestamp time, TrackStatus status) {
  return {{"timestamp", {{"sec", time.ns / kNsPerSecond}, {"nsec", time.ns % kNsPerSecond}}},
          {"status", to_string(status)}};
}

std::string text_of(const nlohmann::json& message) {
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string status_json(const TrackResult& result) {
  nlohmann::json message = status_of(result.timestamp, result.status);
  if (!result.reason.empty()) message["reason"] = result.reason;
  message["tags_detected"] = result.tags_detected;
  message["tags_tracked"] = result.tags_tracked;
  message["second_mode_odds"] = result.second_mode_odds;
  message["latency_ms"] = 1e3 * result.latency_s;
  if (result.exposure) message["exposure_s"] = result.exposure->exposure_s;
  if (result.covariance) {
    message["sigma_position_m"] = std::sqrt(result.covariance->topLeftCorner<3, 3>().trace());
    message["sigma_rotation_rad"] = std::sqrt(result.covariance->bottomRightCorner<3, 3>().trace());
  }
  return text_of(message);
}

}  // namespace

class TrackMcap::Impl {
 public:
  Impl(StagedFiles& files, const std::filesystem::path& path, const Camera& camera, const TagMap& map,
       const Options& options)
      : writer_(files, path),
        camera_(camera),
        map_(map),
        options_(options),
        camera_frame_(camera_frame(camera, map)) {}

  void add(const TrackResult& result, std::span<const TagSight> sights, const SourceFrame* image) {
    if (image) learn_resolution(image->pixels);
    begin(result.timestamp);
    if (image && options_.with_images) add_image(*image);
    if (result.pose) add_pose(result);
    const SceneEntity tags = sights_entity(sights, map_, map_.frame);
    write(FoxgloveType::kSceneUpdate, "/tags", result.timestamp,
          scene_update_json(result.timestamp, {&tags, 1}));
    write(FoxgloveType::kImageAnnotations, "/camera/annotations", result.timestamp,
          image_annotations_json(result.timestamp, sight_outlines(sights)));
    write_status(result.timestamp, status_json(result));
    log(result.timestamp, FoxgloveLevel::kWarning, result.pose ? "" : fmt::format("lost: {}", result.reason));
    if (!result.warning.empty() && result.warning != last_warning_)
      write(FoxgloveType::kLog, "/log", result.timestamp,
            log_json(result.timestamp, FoxgloveLevel::kWarning, "track", last_warning_ = result.warning));
    last_time_ = result.timestamp;
  }

  void add_unreadable(const SourceFrame& frame) {
    write_status(frame.timestamp, text_of(status_of(frame.timestamp, TrackStatus::kUnreadable)));
    log(frame.timestamp, FoxgloveLevel::kError, fmt::format("unreadable: {}: {}", frame.name, frame.error));
  }

  void close() {
    if (last_time_) add_path(*last_time_);
    writer_.close();
  }

 private:
  bool is_ego() const { return options_.mode == TrackMode::kEgo; }
  const std::string& fixed_frame() const { return is_ego() ? map_.frame : camera_frame_; }
  const std::string& moving_frame() const { return is_ego() ? camera_frame_ : map_.frame; }

  std::uint16_t topic(const McapTopic& topic) {
    const auto [found, is_new] = topics_.emplace(topic.name, 0);
    if (is_new) found->second = writer_.add(topic);
    return found->second;
  }

  void write(FoxgloveType type, const std::string& name, Timestamp time, const std::string& message) {
    const auto known = topics_.find(name);
    const std::uint16_t id = known != topics_.end()
                                 ? known->second
                                 : topic({name, "json", std::string(foxglove_schema_name(type)), "jsonschema",
                                          foxglove_schema(type)});
    writer_.write(id, time, message);
  }

  void write_status(Timestamp time, const std::string& message) {
    writer_.write(topic({"/status", "json", kStatusType, "jsonschema", status_schema()}), time, message);
  }

  /// What is said once; players find the last message before the time that they are sent to.
  void begin(Timestamp time) {
    if (last_time_) return;
    const SceneEntity map = map_entity(map_, map_.frame);
    write(FoxgloveType::kSceneUpdate, "/map", time, scene_update_json(time, {&map, 1}));
    if (camera_.width > 0)
      write(FoxgloveType::kCameraCalibration, "/camera/calibration", time,
            camera_calibration_json(time, camera_frame_, camera_));
    if (const auto frustum = frustum_entity(camera_, map_, camera_frame_))
      write(FoxgloveType::kSceneUpdate, "/camera/frustum", time, scene_update_json(time, {&*frustum, 1}));
  }

  void add_pose(const TrackResult& result) {
    const Timestamp time = result.timestamp;
    write(FoxgloveType::kFrameTransform, "/tf", time,
          frame_transform_json(time, fixed_frame(), moving_frame(), *result.pose));
    write(FoxgloveType::kPoseInFrame, "/pose", time, pose_in_frame_json(time, fixed_frame(), *result.pose));
    if (result.covariance) {
      const McapTopic ros = {"/pose_with_covariance", "cdr", std::string(ros_pose_type()), "ros2msg",
                             std::string(ros_pose_definition())};
      writer_.write(
          topic(ros), time,
          ros_pose_cdr(time, fixed_frame(), *result.pose, ros_covariance(*result.pose, *result.covariance)));
    }
    path_.add(result.pose->translation());
    if (!path_time_ || seconds_between(*path_time_, time) >= kPathEvery_s) add_path(time);
  }

  void add_path(Timestamp time) {
    const SceneEntity path = path_.entity(fixed_frame());
    write(FoxgloveType::kSceneUpdate, "/path", time, scene_update_json(time, {&path, 1}));
    path_time_ = time;
  }

  void add_image(const SourceFrame& image) {
    write(FoxgloveType::kCompressedImage, "/camera/image", image.timestamp,
          compressed_image_json(image.timestamp, camera_frame_,
                                encode_jpeg(image.pixels.view(), kJpegQuality), "jpeg"));
  }

  /// Some camera files leave it out.
  void learn_resolution(const GrayImage& image) {
    if (camera_.width > 0) return;
    camera_.width = image.width();
    camera_.height = image.height();
  }

  /// Where it is another message than the last; an empty one is not said.
  void log(Timestamp time, FoxgloveLevel level, const std::string& message) {
    if (!message.empty() && message != last_log_)
      write(FoxgloveType::kLog, "/log", time, log_json(time, level, "track", message));
    last_log_ = message;
  }

  McapWriter writer_;
  Camera camera_;
  const TagMap map_;
  const Options options_;
  const std::string camera_frame_;
  std::map<std::string, std::uint16_t> topics_;
  PathSoFar path_;
  std::optional<Timestamp> last_time_, path_time_;
  std::string last_log_, last_warning_;
};

TrackMcap::TrackMcap(StagedFiles& files, const std::filesystem::path& path, const Camera& camera,
                     const TagMap& map, const Options& options)
    : impl_(std::make_unique<Impl>(files, path, camera, map, options)) {}

TrackMcap::~TrackMcap() = default;

void TrackMcap::add(const TrackResult& result, std::span<const TagSight> sights, const SourceFrame* image) {
  impl_->add(result, sights, image);
}

void TrackMcap::add_unreadable(const SourceFrame& frame) {
  impl_->add_unreadable(frame);
}

void TrackMcap::close() {
  impl_->close();
}

}  // namespace apriltrack::app
