// JSON schemas of Foxglove's messages, as https://github.com/foxglove/foxglove-sdk has them
// (schemas/jsonschema).

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

#include "apriltrack/base/check.h"
#include "apriltrack/export/foxglove.h"

namespace apriltrack {
namespace {

using nlohmann::json;

struct Member {
  const char* name;
  json schema;
  bool is_required = true;
};

json object(std::initializer_list<Member> members) {
  json properties = json::object(), required = json::array();
  for (const Member& member : members) {
    properties[member.name] = member.schema;
    if (member.is_required) required.push_back(member.name);
  }
  return {{"type", "object"}, {"properties", properties}, {"required", required}};
}

json of_type(const char* type) {
  return {{"type", type}};
}

json number() {
  return of_type("number");
}
json text() {
  return of_type("string");
}
json boolean() {
  return of_type("boolean");
}
/// Of indices and sizes.
json count() {
  return {{"type", "integer"}, {"minimum", 0}};
}
json bytes() {
  return {{"type", "string"}, {"contentEncoding", "base64"}};
}
json list(const json& items) {
  return {{"type", "array"}, {"items", items}};
}
json list(const json& items, int size) {
  return {{"type", "array"}, {"items", items}, {"minItems", size}, {"maxItems", size}};
}
/// Numbers with names, from `first` on.
json choice(int first, std::initializer_list<const char*> names) {
  json values = json::array();
  for (const char* name : names) values.push_back({{"title", name}, {"const", first++}});
  return {{"oneOf", values}};
}

/// title: "time", from 1970, or "duration".
json moment(const char* title) {
  json seconds = of_type("integer");
  if (std::string_view(title) == "time") seconds["minimum"] = 0;
  json nanoseconds = count();
  nanoseconds["maximum"] = 999'999'999;
  return {{"type", "object"}, {"title", title}, {"properties", {{"sec", seconds}, {"nsec", nanoseconds}}}};
}

json time() {
  return moment("time");
}
json vector3() {
  return object({{"x", number()}, {"y", number()}, {"z", number()}});
}
json point2() {
  return object({{"x", number()}, {"y", number()}});
}
json quaternion() {
  return object({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}
json pose() {
  return object({{"position", vector3()}, {"orientation", quaternion()}});
}
json colour() {
  return object({{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}});
}
json metadata() {
  return list(object({{"key", text()}, {"value", text()}}));
}

json solid() {
  return object({{"pose", pose()}, {"size", vector3()}, {"color", colour()}});
}

json arrow() {
  return object({{"pose", pose()},
                 {"shaft_length", number()},
                 {"shaft_diameter", number()},
                 {"head_length", number()},
                 {"head_diameter", number()},
                 {"color", colour()}});
}

json cylinder() {
  return object({{"pose", pose()},
                 {"size", vector3()},
                 {"bottom_scale", number()},
                 {"top_scale", number()},
                 {"color", colour()}});
}

json line() {
  return object({{"type", choice(0, {"LINE_STRIP", "LINE_LOOP", "LINE_LIST"})},
                 {"pose", pose()},
                 {"thickness", number()},
                 {"scale_invariant", boolean()},
                 {"points", list(vector3())},
                 {"color", colour()},
                 {"colors", list(colour())},
                 {"indices", list(count())}});
}

json triangles() {
  return object({{"pose", pose()},
                 {"points", list(vector3())},
                 {"color", colour()},
                 {"colors", list(colour())},
                 {"indices", list(count())}});
}

json scene_text() {
  return object({{"pose", pose()},
                 {"billboard", boolean()},
                 {"font_size", number()},
                 {"scale_invariant", boolean()},
                 {"color", colour()},
                 {"text", text()}});
}

json model() {
  return object({{"pose", pose()},
                 {"scale", vector3()},
                 {"color", colour()},
                 {"override_color", boolean()},
                 {"url", text()},
                 {"media_type", text()},
                 {"data", bytes()}});
}

json scene_update() {
  const json deletion =
      object({{"timestamp", time()}, {"type", choice(0, {"MATCHING_ID", "ALL"})}, {"id", text()}});
  const json entity = object({{"timestamp", time()},
                              {"frame_id", text()},
                              {"id", text()},
                              {"lifetime", moment("duration")},
                              {"frame_locked", boolean()},
                              {"metadata", metadata()},
                              {"arrows", list(arrow())},
                              {"cubes", list(solid())},
                              {"spheres", list(solid())},
                              {"cylinders", list(cylinder())},
                              {"lines", list(line())},
                              {"triangles", list(triangles())},
                              {"texts", list(scene_text())},
                              {"models", list(model())}});
  return object({{"deletions", list(deletion)}, {"entities", list(entity)}});
}

json camera_calibration() {
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"width", count()},
                 {"height", count()},
                 {"distortion_model", text()},
                 {"D", list(number())},
                 {"K", list(number(), 9)},
                 {"R", list(number(), 9)},
                 {"P", list(number(), 12)}});
}

json image_annotations() {
  const Member facts = {"metadata", metadata(), false};
  const json circle = object({{"timestamp", time()},
                              {"position", point2()},
                              {"diameter", number()},
                              {"thickness", number()},
                              {"fill_color", colour()},
                              {"outline_color", colour()},
                              facts});
  const json points =
      object({{"timestamp", time()},
              {"type", choice(0, {"UNKNOWN", "POINTS", "LINE_LOOP", "LINE_STRIP", "LINE_LIST"})},
              {"points", list(point2())},
              {"outline_color", colour()},
              {"outline_colors", list(colour())},
              {"fill_color", colour()},
              {"thickness", number()},
              facts});
  const json label = object({{"timestamp", time()},
                             {"position", point2()},
                             {"text", text()},
                             {"font_size", number()},
                             {"text_color", colour()},
                             {"background_color", colour()},
                             facts});
  return object({{"timestamp", time(), false},
                 {"circles", list(circle)},
                 {"points", list(points)},
                 {"texts", list(label)},
                 facts});
}

json schema_of(FoxgloveType type) {
  switch (type) {
    case FoxgloveType::kFrameTransform:
      return object({{"timestamp", time()},
                     {"parent_frame_id", text()},
                     {"child_frame_id", text()},
                     {"translation", vector3()},
                     {"rotation", quaternion()}});
    case FoxgloveType::kPoseInFrame:
      return object({{"timestamp", time()}, {"frame_id", text()}, {"pose", pose()}});
    case FoxgloveType::kSceneUpdate:
      return scene_update();
    case FoxgloveType::kCameraCalibration:
      return camera_calibration();
    case FoxgloveType::kCompressedImage:
      return object({{"timestamp", time()}, {"frame_id", text()}, {"data", bytes()}, {"format", text()}});
    case FoxgloveType::kImageAnnotations:
      return image_annotations();
    case FoxgloveType::kLog:
      return object({{"timestamp", time()},
                     {"level", choice(0, {"UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"})},
                     {"message", text()},
                     {"name", text()},
                     {"file", text()},
                     {"line", count()}});
  }
  APRILTRACK_CHECK(false, "not a FoxgloveType");
}

}  // namespace

std::string_view foxglove_schema_name(FoxgloveType type) {
  switch (type) {
    case FoxgloveType::kFrameTransform:
      return "foxglove.FrameTransform";
    case FoxgloveType::kPoseInFrame:
      return "foxglove.PoseInFrame";
    case FoxgloveType::kSceneUpdate:
      return "foxglove.SceneUpdate";
    case FoxgloveType::kCameraCalibration:
      return "foxglove.CameraCalibration";
    case FoxgloveType::kCompressedImage:
      return "foxglove.CompressedImage";
    case FoxgloveType::kImageAnnotations:
      return "foxglove.ImageAnnotations";
    case FoxgloveType::kLog:
      return "foxglove.Log";
  }
  APRILTRACK_CHECK(false, "not a FoxgloveType");
}

std::string foxglove_schema(FoxgloveType type) {
  json schema = schema_of(type);
  schema["title"] = foxglove_schema_name(type);
  return schema.dump();
}

}  // namespace apriltrack
