#include "nearby_tags.h"

#include <algorithm>
#include <cmath>

#include "view_cone.h"

namespace apriltrack {
namespace {

/// Margins of a choice: what a camera moves from frame to frame, and what particles are apart.
constexpr double kReachOfSight = 0.02;
constexpr double kTurn_rad = 0.2;
/// Of what a path that is longer than that needs.
constexpr double kSlack = 1.5;
/// Of the margins, for rounding: a thousandth of them is not used.
constexpr double kUsableShare = 0.999;
constexpr std::uint32_t kTagsPerLeaf = 8;

double angle_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

bool is_front_in_sight(const PhotometricTag& tag, const MapView& view) {
  const Eigen::Vector3d centre = view.rotation * tag.map_from_plane.col(2) + view.translation;
  return (view.rotation * tag.normal_map).dot(centre) > 0.0 &&
         centre.squaredNorm() < tag.sight_m * tag.sight_m;
}

NearbyTags::NearbyTags(const std::vector<PhotometricTag>& tags) {
  std::vector<double> sights_m;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const PhotometricTag& tag = tags[i];
    tags_.push_back({tag.map_from_plane.col(2), tag.normal_map, tag.radius_m(), tag.sight_m,
                     static_cast<std::uint32_t>(i)});
    sights_m.push_back(tag.sight_m);
  }
  if (tags_.empty()) return;
  const auto middle = sights_m.begin() + static_cast<std::ptrdiff_t>(sights_m.size() / 2);
  std::nth_element(sights_m.begin(), middle, sights_m.end());
  usual_reach_m_ = kReachOfSight * *middle;
  divide(0, static_cast<std::uint32_t>(tags_.size()));
}

Eigen::AlignedBox3d NearbyTags::box_of_centres(std::uint32_t first, std::uint32_t count) const {
  Eigen::AlignedBox3d box;
  for (const Tag& tag : std::span(tags_).subspan(first, count)) box.extend(tag.centre_map);
  return box;
}

NearbyTags::Group NearbyTags::group_of(std::uint32_t first, std::uint32_t count) const {
  Group group{.centre_map = box_of_centres(first, count).center(), .first = first, .count = count};
  for (const Tag& tag : std::span(tags_).subspan(first, count)) {
    group.radius_m = std::max(group.radius_m, (tag.centre_map - group.centre_map).norm() + tag.radius_m);
    group.sight_m = std::max(group.sight_m, tag.sight_m);
  }
  return group;
}

/// Halves along the axis on which the tags lie farthest apart, down to a few.
void NearbyTags::divide(std::uint32_t first, std::uint32_t count) {
  const std::size_t at = groups_.size();
  groups_.push_back(group_of(first, count));
  if (count <= kTagsPerLeaf) return;
  Eigen::Index axis = 0;
  box_of_centres(first, count).sizes().maxCoeff(&axis);
  const auto begin = tags_.begin() + first;
  const std::uint32_t half = count / 2;
  std::nth_element(begin, begin + half, begin + count,
                   [axis](const Tag& a, const Tag& b) { return a.centre_map[axis] < b.centre_map[axis]; });
  divide(first, half);
  groups_[at].second_half = static_cast<std::uint32_t>(groups_.size());
  divide(first + half, count - half);
}

NearbyTags::Eye NearbyTags::eye_of(const MapView& view) {
  return {-(view.rotation.transpose() * view.translation), view.rotation.row(2).transpose()};
}

bool NearbyTags::Choice::holds(std::span<const Eye> eyes, double max_view_angle_rad) const {
  return view_angle_rad == max_view_angle_rad && std::ranges::all_of(eyes, [&](const Eye& other) {
           return (other.position_map - eye.position_map).norm() <= kUsableShare * reach_m &&
                  angle_rad(other.axis_map, eye.axis_map) <= kUsableShare * turn_rad;
         });
}

std::span<const std::uint32_t> NearbyTags::of_path(const ViewPath& path, double max_view_angle_rad) {
  const std::array eyes = {eye_of(path.middle()), eye_of(path.opening()), eye_of(path.closing())};
  ++num_calls_;
  Choice* oldest = &choices_.front();
  for (Choice& choice : choices_) {
    if (choice.holds(eyes, max_view_angle_rad)) {
      choice.last_use = num_calls_;
      return choice.tags;
    }
    if (choice.last_use < oldest->last_use) oldest = &choice;
  }
  choose(eyes, max_view_angle_rad, *oldest);
  oldest->last_use = num_calls_;
  return oldest->tags;
}

void NearbyTags::choose(std::span<const Eye> eyes, double max_view_angle_rad, Choice& choice) const {
  choice.eye = eyes.front();
  choice.view_angle_rad = max_view_angle_rad;
  choice.reach_m = usual_reach_m_;
  choice.turn_rad = kTurn_rad;
  for (const Eye& other : eyes) {
    const double moved_m = (other.position_map - choice.eye.position_map).norm();
    choice.reach_m = std::max(choice.reach_m, kSlack * moved_m);
    choice.turn_rad = std::max(choice.turn_rad, kSlack * angle_rad(other.axis_map, choice.eye.axis_map));
  }
  choice.tags.clear();
  if (!groups_.empty()) add_in_sight(0, choice);
  std::ranges::sort(choice.tags);
}

void NearbyTags::add_in_sight(std::uint32_t at, Choice& choice) const {
  const Eye& eye = choice.eye;
  const double cone_rad = choice.view_angle_rad + choice.turn_rad;
  // The cone's axis looks along z: what is asked of a direction is only its angle off that axis.
  const auto may_pass = [&](const Eigen::Vector3d& way, double radius_m) {
    const double along = way.dot(eye.axis_map);
    return may_be_in_view({(way - along * eye.axis_map).norm(), 0.0, along}, radius_m + choice.reach_m,
                          cone_rad);
  };
  const Group& group = groups_[at];
  const Eigen::Vector3d to_group = group.centre_map - eye.position_map;
  if (to_group.norm() > group.sight_m + group.radius_m + choice.reach_m) return;
  if (!may_pass(to_group, group.radius_m)) return;
  if (group.second_half > 0) {
    add_in_sight(at + 1, choice);
    add_in_sight(group.second_half, choice);
    return;
  }
  for (const Tag& tag : std::span(tags_).subspan(group.first, group.count)) {
    const Eigen::Vector3d way = tag.centre_map - eye.position_map;
    if (way.norm() < tag.sight_m + choice.reach_m && tag.normal_map.dot(way) > -choice.reach_m &&
        may_pass(way, tag.radius_m))
      choice.tags.push_back(tag.index);
  }
}

}  // namespace apriltrack
