// TagSLAM's bodies with their tags: poses.yaml, which it writes, and tagslam.yaml, by which it is told
// (body.cpp, tag.cpp and yaml_utils.cpp of berndpfrommer/tagslam). T_body_tag, rotations as rotation vectors;
// tags with y up and z out of the face (tag.cpp: corners from bottom left, y up). `center` and `rotvec` are
// what earlier versions called position and rotation, and then they stood in the tag itself.
#include "tagslam.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "../tag_fields.h"
#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/io/numbers.h"
#include "bundles.h"
#include "map_words.h"
#include "tagslam_noise.h"

namespace apriltrack {
namespace {

/// TagSLAM's `bits`: data bits along an edge.
constexpr std::array<std::pair<int, std::string_view>, 3> kBitsOfFamilies = {
    {{6, "tag36h11"}, {5, "tag25h9"}, {4, "tag16h5"}}};
/// TagSLAM wants a noise with each pose: of tags whose covariance is not known, m and rad.
constexpr double kAssumedNoise = 1e-3;
/// The least one, for TagSLAM divides by it, m and rad: of tags that are held.
constexpr double kLeastNoise = 1e-6;

struct TagSlamBody {
  TagBundle bundle;
  bool is_static = true;
  std::optional<Pose> T_world_body;
  std::optional<Matrix6d> covariance;  ///< Of T_world_body, along the body's axes.
};

Eigen::Vector3d tagslam_vector(const YamlNode& node) {
  return {node.at("x").as_double(), node.at("y").as_double(), node.at("z").as_double()};
}

/// Of {position, rotation}, or {center, rotvec}; nullopt where it has neither.
std::optional<Pose> tagslam_pose(const YamlNode& node) {
  auto position = node.find("position");
  auto rotation = node.find("rotation");
  if (!position) position = node.find("center");
  if (!rotation) rotation = node.find("rotvec");
  if (!position && !rotation) return std::nullopt;
  if (!position || !rotation) node.fail("must have both position and rotation");
  for (const char* key : {"x", "y", "z"}) read_coordinate(position->at(key));
  const Eigen::Vector3d rotation_vector = tagslam_vector(*rotation);
  if (!(rotation_vector.norm() < 100.0)) rotation->fail("must be a rotation vector in radians");
  return Pose(rotation_exp(rotation_vector), tagslam_vector(*position));
}

std::optional<std::string> tagslam_family(const YamlNode& tag) {
  const auto bits = tag.find("bits");
  if (!bits) return std::nullopt;
  const int number = bits->as_int();
  for (const auto& [known, family] : kBitsOfFamilies) {
    if (known == number) return std::string(family);
  }
  bits->fail(fmt::format("must be 6 (tag36h11), 5 (tag25h9) or 4 (tag16h5) (is {})", number));
}

/// nullopt of a tag whose pose TagSLAM is yet to find.
std::optional<ForeignTag> tagslam_tag(const YamlNode& node, const std::optional<double>& default_size_m) {
  const YamlNode pose = node.find("pose").value_or(node);
  const auto T_body_theirs = tagslam_pose(pose);
  if (!T_body_theirs) return std::nullopt;
  const auto size = node.find("size");
  ForeignTag tag;
  tag.place = MapPlace::of(node);
  tag.id = node.at("id").as_int();
  tag.family = tagslam_family(node);
  tag.size_m = size ? std::optional(read_tag_size(*size)) : default_size_m;
  tag.T_map_tag = pose_from_frame(*T_body_theirs, rotation_ros_tag());
  if (const auto covariance = covariance_of_tagslam(pose))
    tag.covariance = covariance_from_frame(*covariance, rotation_ros_tag());
  return tag;
}

TagSlamBody tagslam_body(const std::string& name, const YamlNode& node,
                         std::vector<std::string>& without_pose) {
  TagSlamBody body{{name, {}}, true, std::nullopt, std::nullopt};
  if (const auto is_static = node.find("is_static")) body.is_static = is_static->as_bool();
  if (const auto pose = node.find("pose"); pose && pose->is_map()) {
    body.T_world_body = tagslam_pose(*pose);
    body.covariance = covariance_of_tagslam(*pose);
  }
  std::optional<double> default_size_m;
  if (const auto size = node.find("default_tag_size"); size && size->as_double() > 0.0)
    default_size_m = read_tag_size(*size);
  const auto tags = node.find("tags");
  if (!tags || tags->is_null()) return body;
  for (const YamlNode& item : tags->items()) {
    if (auto tag = tagslam_tag(item, default_size_m))
      body.bundle.tags.push_back(*std::move(tag));
    else
      without_pose.push_back(item.at("id").as_string());
  }
  return body;
}

/// Bodies that have tags with poses.
std::vector<TagSlamBody> tagslam_bodies(const YamlNode& root, std::vector<std::string>& without_pose) {
  std::vector<TagSlamBody> bodies;
  const YamlNode list = root.find("bodies") ? root.at("bodies") : root.at("static_objects");
  for (const YamlNode& item : list.items()) {
    for (const auto& [name, node] : item.entries()) {
      if (!node.is_map()) continue;
      TagSlamBody body = tagslam_body(name, node, without_pose);
      if (!body.bundle.tags.empty()) bodies.push_back(std::move(body));
    }
  }
  return bodies;
}

/// Whether together they are one map: of a world in which none of them moves.
bool stand_still(const std::vector<TagSlamBody>& bodies) {
  return std::ranges::all_of(bodies,
                             [](const TagSlamBody& body) { return body.is_static && body.T_world_body; });
}

std::vector<ForeignTag> tags_in_world(const std::vector<TagSlamBody>& bodies) {
  std::vector<ForeignTag> tags;
  for (const TagSlamBody& body : bodies) {
    for (ForeignTag tag : body.bundle.tags) {
      if (tag.covariance && body.covariance) {
        // T_world_body exp(xi) T_body_tag = T_world_tag exp(Ad(T_tag_body) xi).
        const Matrix6d to_tag = tag.T_map_tag.inverse().adjoint();
        *tag.covariance += to_tag * *body.covariance * to_tag.transpose();
      }
      tag.T_map_tag = *body.T_world_body * tag.T_map_tag;
      tags.push_back(std::move(tag));
    }
  }
  return tags;
}

std::string text_of_vector(const Eigen::Vector3d& v) {
  return fmt::format("{{x: {}, y: {}, z: {}}}", yaml_double(v.x()), yaml_double(v.y()), yaml_double(v.z()));
}

std::string text_of_tagslam_pose(const Pose& pose, const std::string& indent) {
  return fmt::format("{0}position: {1}\n{0}rotation: {2}\n", indent, text_of_vector(pose.translation()),
                     text_of_vector(rotation_log(pose.rotation())));
}

std::optional<int> bits_of(const std::string& family) {
  for (const auto& [bits, known] : kBitsOfFamilies) {
    if (known == family) return bits;
  }
  return std::nullopt;
}

/// The noise of a tag; notes in `assumed` tags whose covariance cannot be written as it is.
std::string tagslam_noise_of(const MapTag& tag, const std::string& indent,
                             std::vector<std::string>& assumed) {
  if (tag.covariance) {
    if (const auto text = text_of_tagslam_covariance(*tag.covariance, indent)) return *text;
  }
  assumed.push_back(to_string(tag.key));
  const Vector6d sigmas =
      tag.covariance ? Vector6d(tag.covariance->diagonal().cwiseSqrt()) : Vector6d::Constant(kAssumedNoise);
  return text_of_tagslam_sigmas(sigmas, kLeastNoise, indent);
}

}  // namespace

bool is_tagslam(const MapText& text) {
  if (!text.root || !text.root->is_map()) return false;
  return text.root->find("bodies") || text.root->find("static_objects");
}

MapReading read_tagslam(const MapText& text, const MapReadOptions& options) {
  std::vector<std::string> without_pose, foreign;
  note_foreign_keys(*text.root, {"bodies", "static_objects"}, foreign);
  const std::vector<TagSlamBody> bodies = tagslam_bodies(*text.root, without_pose);
  if (bodies.empty())
    throw invalid_input(text.file,
                        "this file of TagSLAM has no body that has tags with poses: its poses.yaml has them");
  std::vector<ConversionLoss> losses;
  if (!without_pose.empty())
    losses.push_back({.kind = LossKind::kTags,
                      .value = fmt::format("{}, which have no pose", fmt::join(without_pose, ", "))});
  add_foreign_keys(foreign, losses);
  if (options.bundle.empty() && stand_still(bodies)) {
    // Of one body that is at the origin the map is its own: how well the world knows it is no matter.
    const bool is_own = bodies.size() == 1 && bodies[0].T_world_body->log().isZero(0.0);
    return map_of(MapFormat::kTagSlam, options, text.file, is_own ? bodies[0].bundle.name : "world",
                  is_own ? bodies[0].bundle.tags : tags_in_world(bodies), std::move(losses));
  }
  std::vector<TagBundle> bundles;
  for (const TagSlamBody& body : bodies) bundles.push_back(body.bundle);
  const TagBundle bundle = chosen_bundle(bundles, options, text.file, "body", losses);
  return map_of(MapFormat::kTagSlam, options, text.file, bundle.name, bundle.tags, std::move(losses));
}

std::string write_tagslam(const TagMap& map, const MapWriteOptions&, const std::string& file,
                          std::vector<ConversionLoss>& losses) {
  require_distinct_ids(map, MapFormat::kTagSlam, file);
  const std::string name = ros_name(map.frame);
  if (name != map.frame)
    losses.push_back({.kind = LossKind::kFrameName, .how = LossHow::kConverted, .value = name});
  std::vector<std::string> assumed, without_family;
  std::string tags;
  for (const MapTag& tag : map.tags) {
    tags += fmt::format("       - id: {}\n         size: {}\n", tag.key.id, yaml_double(tag.size_m));
    if (const auto bits = bits_of(tag.key.family))
      tags += fmt::format("         bits: {}\n", *bits);
    else
      without_family.push_back(to_string(tag.key));
    tags += "         pose:\n" +
            text_of_tagslam_pose(pose_to_frame(tag.T_map_tag, rotation_ros_tag()), "           ") +
            tagslam_noise_of(tag, "           ", assumed);
  }
  if (!without_family.empty()) losses.push_back({.kind = LossKind::kFamilies, .which = without_family});
  if (!assumed.empty())
    losses.push_back(
        {.kind = LossKind::kCovariance,
         .how = LossHow::kAssumed,
         .which = assumed,
         .value = "1 mm and 1 mrad where it is not known; where it has no inverse, its variances, and at "
                  "least (0.001 mm)^2 and (0.001 mrad)^2"});
  add_left_out(map, {.sizes = true, .families = true, .covariances = true, .frame_name = true}, losses);
  return fmt::format(
             "# Body for TagSLAM. Metres, radians; T_body_tag, rotation vectors, tags with y up and z out of "
             "the face.\nbodies:\n - {}:\n     type: simple\n     is_static: true\n"
             "     default_tag_size: {}\n     pose:\n",
             name, yaml_double(map.tags.front().size_m)) +
         text_of_tagslam_pose(Pose(), "       ") +
         text_of_tagslam_sigmas(Vector6d::Zero(), kLeastNoise, "       ") + "     tags:\n" + tags;
}

}  // namespace apriltrack
