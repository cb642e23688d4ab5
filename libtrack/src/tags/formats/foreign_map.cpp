#include "foreign_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "../tag_faults.h"
#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rounded_rotation.h"
#include "apriltrack/tags/tag_key_fault.h"

namespace apriltrack {
namespace {

constexpr double kSizesAgree_m = 1e-9;
constexpr const char* kUsualFamily = "tag36h11";

/// "1, 2, 3, ...".
std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;
  const std::vector<std::string> first(names.begin(),
                                       names.begin() + static_cast<long>(std::min(kMost, names.size())));
  return fmt::format("{}{}", fmt::join(first, ", "), names.size() > kMost ? ", ..." : "");
}

void check_size_agrees(double own_m, const TagKey& key, const MapReadOptions& options,
                       const MapPlace& place) {
  const auto given_m = options.sizes.find(key);
  if (options.only_where_missing || !given_m || std::abs(*given_m - own_m) <= kSizesAgree_m) return;
  place.fail(
      fmt::format("tag {} is {} m here, and {} m by --tag-size or --tag-sizes: leave these out, or give "
                  "the same",
                  to_string(key), own_m, *given_m));
}

void check_family_agrees(const std::string& own, const MapReadOptions& options, const MapPlace& place) {
  if (options.only_where_missing || !options.family || *options.family == own) return;
  place.fail(fmt::format("the family is {} here, and {} by --family: leave that out, or give the same", own,
                         *options.family));
}

TagKey key_of(const ForeignTag& tag, const MapReadOptions& options) {
  if (tag.family) check_family_agrees(*tag.family, options, tag.place);
  TagKey key{tag.family.value_or(options.family.value_or(kUsualFamily)), tag.id};
  if (const auto fault = fault_of_key(key)) {
    const bool is_guess = !tag.family && !options.family;
    tag.place.fail(*fault + (is_guess ? "; the file names no family: give it by --family" : ""));
  }
  return key;
}

/// Keys whose family the file does not name.
void note_families(const std::vector<ForeignTag>& tags, const std::vector<TagKey>& keys,
                   const MapReadOptions& options, std::vector<ConversionLoss>& losses) {
  std::vector<std::string> open;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (!tags[i].family) open.push_back(to_string(keys[i]));
  }
  if (open.empty()) return;
  losses.push_back({.kind = LossKind::kFamilies,
                    .how = options.family ? LossHow::kGiven : LossHow::kAssumed,
                    .which = open.size() == tags.size() ? std::vector<std::string>() : open,
                    .value = options.family.value_or(kUsualFamily)});
}

[[noreturn]] void fail_without_sizes(MapFormat format, const std::string& file,
                                     const std::vector<std::string>& names, UsualSizes usual) {
  throw invalid_input(
      file,
      fmt::format("this {} states no size of tag{} {}: give it by --tag-size METRES or --tag-sizes FILE, "
                  "or convert it once: apriltrack map convert {} map.yaml --tag-size METRES{}{}",
                  info_of(format).title, names.size() == 1 ? "" : "s", some_of(names), file,
                  usual.text.empty() ? "" : "; ", usual.text));
}

}  // namespace

void MapPlace::fail(const std::string& what) const {
  throw invalid_input(where, path.empty() ? what : path + ": " + what);
}

void check_agreement(const TagMap& map, const MapReadOptions& options, const std::string& where) {
  for (const MapTag& tag : map.tags) {
    const MapPlace place{where, "tag " + to_string(tag.key)};
    check_family_agrees(tag.key.family, options, place);
    check_size_agrees(tag.size_m, tag.key, options, place);
  }
}

MapReading map_of(MapFormat format, const MapReadOptions& options, const std::string& file,
                  const std::string& frame, const std::vector<ForeignTag>& tags,
                  std::vector<ConversionLoss> losses, UsualSizes usual) {
  if (tags.empty()) throw invalid_input(file, "has no tags: a layout needs at least one");
  MapReading reading{.map = {}, .format = format, .losses = std::move(losses)};
  reading.map.frame = frame;
  std::map<TagKey, MapPlace> places;
  std::vector<TagKey> keys;
  std::vector<std::string> sized, without_size;
  for (const ForeignTag& foreign : tags) {
    MapTag tag;
    tag.key = key_of(foreign, options);
    keys.push_back(tag.key);
    const auto [first, is_new] = places.emplace(tag.key, foreign.place);
    if (!is_new)
      foreign.place.fail(
          fmt::format("tag {} is already defined at {}: a layout with two tags of one id cannot "
                      "tell which is seen",
                      to_string(tag.key), first->second.where));
    if (foreign.size_m) {
      if (const auto fault = fault_of_size(*foreign.size_m)) foreign.place.fail("size: " + *fault);
      check_size_agrees(*foreign.size_m, tag.key, options, foreign.place);
      tag.size_m = *foreign.size_m;
    } else if (const auto given_m = options.sizes.find(tag.key)) {
      tag.size_m = *given_m;
      sized.push_back(to_string(tag.key));
    } else {
      without_size.push_back(std::to_string(foreign.id));
    }
    tag.T_map_tag = foreign.T_map_tag;
    tag.covariance = foreign.covariance;
    reading.map.tags.push_back(std::move(tag));
  }
  if (!without_size.empty()) fail_without_sizes(format, file, without_size, usual);
  reading.map.default_family = keys.front().family;
  note_families(tags, keys, options, reading.losses);
  if (!sized.empty())
    reading.losses.push_back({.kind = LossKind::kSizes,
                              .how = LossHow::kGiven,
                              .which = sized.size() == tags.size() ? std::vector<std::string>() : sized});
  check_tag_map(reading.map, file);
  return reading;
}

void note_foreign_keys(const YamlNode& node, std::initializer_list<std::string_view> known,
                       std::vector<std::string>& seen) {
  for (const auto& [key, value] : node.entries()) {
    if (std::find(known.begin(), known.end(), key) == known.end() &&
        std::find(seen.begin(), seen.end(), key) == seen.end())
      seen.push_back(key);
  }
}

void add_foreign_keys(const std::vector<std::string>& seen, std::vector<ConversionLoss>& losses) {
  if (seen.empty()) return;
  losses.push_back({.kind = LossKind::kForeignKeys, .value = some_of(seen)});
}

double read_coordinate(const YamlNode& node) {
  const double position_m = node.as_double();
  if (const auto fault = fault_of_coordinate(position_m)) node.fail(*fault);
  return position_m;
}

Eigen::Quaterniond read_unit_quaternion(const YamlNode& node, double w, double x, double y, double z) {
  const Eigen::Quaterniond rotation(w, x, y, z);
  if (const auto fault = fault_of_quaternion(rotation)) node.fail(*fault);
  return rotation;
}

Eigen::Quaterniond checked_rotation(const Eigen::Matrix3d& matrix, const MapPlace& place) {
  constexpr double kRounding = 5e-3;
  if (const auto rotation = rounded_rotation(matrix, kRounding))
    return Eigen::Quaterniond(*rotation).normalized();
  place.fail(
      fmt::format("its upper left 3x3 must be a rotation (determinant {:.4g}, columns off by up to {:.3g} "
                  "from unit length and right angles)",
                  matrix.determinant(), rotation_defect(matrix)));
}

const Eigen::Quaterniond& rotation_ros_tag() {
  static const Eigen::Quaterniond rotation(0.0, 1.0, 0.0, 0.0);  // by 180 degrees about x
  return rotation;
}

const Eigen::Quaterniond& rotation_opencv_tag() {
  static const Eigen::Quaterniond rotation(0.0, 0.0, 1.0, 0.0);  // by 180 degrees about y
  return rotation;
}

const Eigen::Quaterniond& rotation_wpilib_tag() {
  // Our x, y, z are their y, -z, -x: columns (0 1 0), (0 0 -1), (-1 0 0).
  static const Eigen::Quaterniond rotation(0.5, -0.5, -0.5, 0.5);
  return rotation;
}

Pose pose_from_frame(const Pose& T_map_theirs, const Eigen::Quaterniond& rotation_theirs_ours) {
  return {T_map_theirs.rotation() * rotation_theirs_ours, T_map_theirs.translation()};
}

Pose pose_to_frame(const Pose& T_map_ours, const Eigen::Quaterniond& rotation_theirs_ours) {
  return {T_map_ours.rotation() * rotation_theirs_ours.conjugate(), T_map_ours.translation()};
}

Matrix6d covariance_from_frame(const Matrix6d& theirs, const Eigen::Quaterniond& rotation_theirs_ours) {
  // T_map_theirs exp(xi) T_theirs_ours = T_map_ours exp(Ad(T_ours_theirs) xi), and T_theirs_ours only turns.
  const Matrix6d turn = Pose(rotation_theirs_ours.conjugate(), Eigen::Vector3d::Zero()).adjoint();
  return turn * theirs * turn.transpose();
}

Matrix6d covariance_to_frame(const Matrix6d& ours, const Eigen::Quaterniond& rotation_theirs_ours) {
  return covariance_from_frame(ours, rotation_theirs_ours.conjugate());
}

}  // namespace apriltrack
