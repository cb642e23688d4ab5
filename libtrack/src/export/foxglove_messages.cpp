#include <nlohmann/json.hpp>
#include <variant>

#include "apriltrack/base/error.h"
#include "apriltrack/export/foxglove.h"
#include "apriltrack/io/base64.h"

namespace apriltrack {
namespace {

using nlohmann::json;

json time_json(Timestamp time) {
  if (time.ns < 0)
    throw invalid_input(
        format_seconds(time) + " s",
        "lies before 1970, and Foxglove's messages have no such times: choose another format");
  return {{"sec", time.ns / kNsPerSecond}, {"nsec", time.ns % kNsPerSecond}};
}

json vector_json(const Eigen::Vector3d& v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

json quaternion_json(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}

json pose_json(const Pose& pose) {
  return {{"position", vector_json(pose.translation())}, {"orientation", quaternion_json(pose.rotation())}};
}

json colour_json(const SceneColour& colour) {
  return {{"r", colour.red}, {"g", colour.green}, {"b", colour.blue}, {"a", colour.opacity}};
}

json line_json(const SceneLine& line) {
  constexpr int kLineStrip = 0, kLineLoop = 1;
  json points = json::array();
  for (const Eigen::Vector3d& point : line.points) points.push_back(vector_json(point));
  return {{"type", line.is_closed ? kLineLoop : kLineStrip},
          {"pose", pose_json({})},
          {"thickness", line.width_px},
          {"scale_invariant", true},
          {"points", points},
          {"color", colour_json(line.colour)},
          {"colors", json::array()},
          {"indices", json::array()}};
}

/// All in one list, each with its colour.
json quads_json(const std::vector<SceneQuad>& quads) {
  json points = json::array(), colours = json::array(), indices = json::array();
  for (const SceneQuad& quad : quads) {
    const std::size_t first = points.size();
    for (const Eigen::Vector3d& corner : quad.corners) {
      points.push_back(vector_json(corner));
      colours.push_back(colour_json(quad.colour));
    }
    for (const std::size_t corner : {0, 1, 2, 0, 2, 3}) indices.push_back(first + corner);
  }
  return {{"pose", pose_json({})},
          {"points", points},
          {"color", colour_json({})},
          {"colors", colours},
          {"indices", indices}};
}

json scene_text_json(const SceneText& text) {
  return {{"pose", pose_json({Eigen::Quaterniond::Identity(), text.position})},
          {"billboard", true},
          {"font_size", text.height_m},
          {"scale_invariant", false},
          {"color", colour_json(text.colour)},
          {"text", text.text}};
}

json facts_json(const std::vector<std::pair<std::string, std::string>>& facts) {
  json all = json::array();
  for (const auto& [key, value] : facts) all.push_back({{"key", key}, {"value", value}});
  return all;
}

json entity_json(Timestamp time, const SceneEntity& entity) {
  json lines = json::array(), texts = json::array(), triangles = json::array();
  for (const SceneLine& line : entity.lines) lines.push_back(line_json(line));
  for (const SceneText& text : entity.texts) texts.push_back(scene_text_json(text));
  if (!entity.quads.empty()) triangles.push_back(quads_json(entity.quads));
  return {{"timestamp", time_json(time)},
          {"frame_id", entity.frame},
          {"id", entity.id},
          {"lifetime", {{"sec", 0}, {"nsec", 0}}},  // until it is replaced
          {"frame_locked", true},
          {"metadata", facts_json(entity.facts)},
          {"arrows", json::array()},
          {"cubes", json::array()},
          {"spheres", json::array()},
          {"cylinders", json::array()},
          {"lines", lines},
          {"triangles", triangles},
          {"texts", texts},
          {"models", json::array()}};
}

/// Name and coefficients as Foxglove's pinhole and kannala_brandt models want them.
struct Lens {
  std::string model;
  std::vector<double> coefficients;
};

struct LensOf {
  Lens operator()(const NoDistortion&) const { return {}; }
  Lens operator()(const RadtanDistortion& lens) const {
    std::vector<double> d = lens.coefficients();
    const bool is_rational = d.size() > 5;
    d.resize(is_rational ? 8 : 5, 0.0);
    return {is_rational ? "rational_polynomial" : "plumb_bob", d};
  }
  Lens operator()(const EquidistantDistortion& lens) const { return {"kannala_brandt", lens.coefficients()}; }
};

/// Foxglove's origin is the corner of the pixel whose centre is ours.
json point_json(const Eigen::Vector2d& pixel) {
  return {{"x", pixel.x() + 0.5}, {"y", pixel.y() + 0.5}};
}

constexpr SceneColour kClear{0.0, 0.0, 0.0, 0.0};

json outline_json(Timestamp time, const PictureOutline& outline) {
  constexpr int kLineLoop = 2;
  constexpr double kWidth_px = 2.0;
  json points = json::array();
  for (const Eigen::Vector2d& corner : outline.corners_px) points.push_back(point_json(corner));
  return {{"timestamp", time_json(time)},
          {"type", kLineLoop},
          {"points", points},
          {"outline_color", colour_json(outline.colour)},
          {"outline_colors", json::array()},
          {"fill_color", colour_json(kClear)},
          {"thickness", kWidth_px}};
}

json label_json(Timestamp time, const PictureOutline& outline) {
  constexpr double kHeight_px = 12.0;
  return {{"timestamp", time_json(time)},
          {"position", point_json(outline.corners_px.front())},
          {"text", outline.text},
          {"font_size", kHeight_px},
          {"text_color", colour_json(outline.colour)},
          {"background_color", colour_json(kClear)}};
}

/// A name that is no UTF-8 is shown as far as it is.
std::string text_of(const json& message) {
  return message.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

std::string frame_transform_json(Timestamp time, std::string_view parent, std::string_view child,
                                 const Pose& T_parent_child) {
  return text_of({{"timestamp", time_json(time)},
                  {"parent_frame_id", parent},
                  {"child_frame_id", child},
                  {"translation", vector_json(T_parent_child.translation())},
                  {"rotation", quaternion_json(T_parent_child.rotation())}});
}

std::string pose_in_frame_json(Timestamp time, std::string_view frame, const Pose& T_frame_pose) {
  return text_of({{"timestamp", time_json(time)}, {"frame_id", frame}, {"pose", pose_json(T_frame_pose)}});
}

std::string scene_update_json(Timestamp time, std::span<const SceneEntity> entities) {
  constexpr int kAll = 1;
  json all = json::array(), deletions = json::array();
  for (const SceneEntity& entity : entities) all.push_back(entity_json(time, entity));
  if (entities.empty()) deletions.push_back({{"timestamp", time_json(time)}, {"type", kAll}, {"id", ""}});
  return text_of({{"deletions", deletions}, {"entities", all}});
}

std::string camera_calibration_json(Timestamp time, std::string_view frame, const Camera& camera) {
  const Pinhole& p = camera.model.pinhole();
  const Lens lens = std::visit(LensOf(), camera.model.distortion());
  return text_of({{"timestamp", time_json(time)},
                  {"frame_id", frame},
                  {"width", camera.width},
                  {"height", camera.height},
                  {"distortion_model", lens.model},
                  {"D", lens.coefficients},
                  {"K", {p.fx, 0.0, p.cx, 0.0, p.fy, p.cy, 0.0, 0.0, 1.0}},
                  {"R", {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}},
                  {"P", {p.fx, 0.0, p.cx, 0.0, 0.0, p.fy, p.cy, 0.0, 0.0, 0.0, 1.0, 0.0}}});
}

std::string compressed_image_json(Timestamp time, std::string_view frame, std::string_view bytes,
                                  std::string_view format) {
  return text_of(
      {{"timestamp", time_json(time)}, {"frame_id", frame}, {"data", base64(bytes)}, {"format", format}});
}

std::string image_annotations_json(Timestamp time, std::span<const PictureOutline> outlines) {
  json points = json::array(), texts = json::array();
  for (const PictureOutline& outline : outlines) {
    if (outline.corners_px.empty()) continue;
    points.push_back(outline_json(time, outline));
    if (!outline.text.empty()) texts.push_back(label_json(time, outline));
  }
  return text_of(
      {{"timestamp", time_json(time)}, {"circles", json::array()}, {"points", points}, {"texts", texts}});
}

std::string log_json(Timestamp time, FoxgloveLevel level, std::string_view name, std::string_view message) {
  return text_of({{"timestamp", time_json(time)},
                  {"level", static_cast<int>(level)},
                  {"message", message},
                  {"name", name},
                  {"file", ""},
                  {"line", 0}});
}

}  // namespace apriltrack
