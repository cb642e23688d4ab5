// TagSLAM's bodies with their tags: poses.yaml, which it writes, and tagslam.yaml, by which it is told
// (body.cpp, tag.cpp and yaml_utils.cpp of berndpfrommer/tagslam; boards: tagslam_board.cpp). T_body_tag,
// rotations as rotation vectors; tags with y up and z out of the face (tag.cpp: corners from bottom left, y
// up). `center` and `rotvec` are what earlier versions called position and rotation, and then they stood in
// the tag itself.
#include "tagslam.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "../tag_fields.h"
#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/io/numbers.h"
#include "bundles.h"
#include "map_words.h"
#include "tagslam_board.h"
#include "tagslam_fields.h"
#include "tagslam_noise.h"

namespace apriltrack {
namespace {

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

/// nullopt of a tag whose pose TagSLAM is yet to find.
std::optional<ForeignTag> tagslam_tag(const YamlNode& node, const std::optional<double>& default_size_m,
                                      std::vector<std::string>& foreign) {
  note_foreign_keys(node,
                    {"id", "bits", "size", "pose", "position", "rotation", "center", "rotvec", "R",
                     "position_noise", "rotation_noise"},
                    foreign);
  const YamlNode pose = node.find("pose").value_or(node);
  const auto T_body_theirs = tagslam_pose(pose);
  if (!T_body_theirs) return std::nullopt;
  const auto size = node.find("size");
  ForeignTag tag;
  tag.place = MapPlace::of(node);
  tag.id = node.at("id").as_int();
  if (const auto bits = node.find("bits")) tag.family = family_of_bits(*bits);
  tag.size_m = size ? std::optional(read_tag_size(*size)) : default_size_m;
  tag.T_map_tag = pose_from_frame(*T_body_theirs, rotation_ros_tag());
  if (const auto covariance = covariance_of_tagslam(pose))
    tag.covariance = covariance_from_frame(*covariance, rotation_ros_tag());
  return tag;
}

/// What is passed over.
struct TagSlamRest {
  std::vector<std::string> without_pose;  ///< Tags.
  std::vector<std::string> foreign;       ///< Keys.
};

/// Those of a grid, but for tags that `body` has already: their poses are what TagSLAM made of the grid's.
void add_tags_of_board(const YamlNode& node, const std::string& type, TagBundle& body, TagSlamRest& rest) {
  for (ForeignTag& tag : tags_of_tagslam_board(type, node.at(type), rest.foreign)) {
    if (std::ranges::find(body.tags, tag.id, &ForeignTag::id) == body.tags.end())
      body.tags.push_back(std::move(tag));
  }
}

TagSlamBody tagslam_body(const std::string& name, const YamlNode& node, TagSlamRest& rest) {
  TagSlamBody body{{name, {}}, true, std::nullopt, std::nullopt};
  const auto stated_type = node.find("type");
  const std::string type = stated_type ? stated_type->as_string() : "simple";
  const bool is_board = is_tagslam_board(type) && node.find(type);
  note_foreign_keys(node, {"type", "is_static", "pose", "default_tag_size", "tags", is_board ? type : "tags"},
                    rest.foreign);
  if (const auto is_static = node.find("is_static")) body.is_static = is_static->as_bool();
  if (const auto pose = node.find("pose"); pose && pose->is_map()) {
    body.T_world_body = tagslam_pose(*pose);
    body.covariance = covariance_of_tagslam(*pose);
  }
  std::optional<double> default_size_m;
  if (const auto size = node.find("default_tag_size"); size && size->as_double() > 0.0)
    default_size_m = read_tag_size(*size);
  if (const auto tags = node.find("tags"); tags && !tags->is_null()) {
    for (const YamlNode& item : tags->items()) {
      if (auto tag = tagslam_tag(item, default_size_m, rest.foreign))
        body.bundle.tags.push_back(*std::move(tag));
      else
        rest.without_pose.push_back(item.at("id").as_string());
    }
  }
  if (is_board) add_tags_of_board(node, type, body.bundle, rest);
  return body;
}

/// Bodies that have tags with poses.
std::vector<TagSlamBody> tagslam_bodies(const YamlNode& root, TagSlamRest& rest) {
  std::vector<TagSlamBody> bodies;
  const YamlNode list = root.find("bodies") ? root.at("bodies") : root.at("static_objects");
  for (const YamlNode& item : list.items()) {
    for (const auto& [name, node] : item.entries()) {
      if (!node.is_map()) continue;
      TagSlamBody body = tagslam_body(name, node, rest);
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
  TagSlamRest rest;
  note_foreign_keys(*text.root, {"bodies", "static_objects"}, rest.foreign);
  const std::vector<TagSlamBody> bodies = tagslam_bodies(*text.root, rest);
  if (bodies.empty())
    throw invalid_input(text.file,
                        "this file of TagSLAM has no body that has tags with poses: its poses.yaml has them");
  std::vector<ConversionLoss> losses;
  if (!rest.without_pose.empty())
    losses.push_back({.kind = LossKind::kTags,
                      .value = fmt::format("{}, which have no pose", fmt::join(rest.without_pose, ", "))});
  add_foreign_keys(rest.foreign, losses);
  if (options.bundle.empty() && stand_still(bodies)) {
    // A single body at the origin is its own frame: the noise of its pose in the world is irrelevant.
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
    if (const auto bits = bits_of_family(tag.key.family))
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
