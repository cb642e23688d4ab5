// One fault in an else sound world: in what hangs there, or in the files that tell of it.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "apriltrack/base/timestamp.h"
#include "draw.h"
#include "truth.h"

namespace apriltrack::worlds {
namespace {

using std::numbers::pi;

// Good views of a tag that is to be found out; of one that moves, before and after.
constexpr int kLeastViews = 8;
constexpr int kLeastViewsPerPlace = 4;
constexpr std::size_t kLeastCandidates = 3;

struct Culprit {
  std::size_t tag = 0;
  std::vector<double> times_s;  ///< Of its good views.
};

/// Joined tags that are seen well often enough.
std::vector<Culprit> candidates(const World& world) {
  const auto frames = all_views(world);
  std::vector<Culprit> all;
  for (const std::size_t tag : joined_tags(world, frames)) {
    Culprit one{.tag = tag, .times_s = {}};
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const bool is_seen =
          std::ranges::any_of(frames[i], [&](const TrueView& v) { return v.tag == tag && v.is_good(); });
      if (is_seen) one.times_s.push_back(seconds_between(Timestamp{}, world.scene.timestamp(i)));
    }
    if (static_cast<int>(one.times_s.size()) >= kLeastViews) all.push_back(one);
  }
  return all;
}

double print_half_m(const World& world, const PlacedTag& tag) {
  const TagFamily& family = TagFamily::get(tag.key.family);
  return tag.size_m / family.width_at_border() * (0.5 * family.total_width() + world.print.margin_cells);
}

/// The tag on a thin plate of its own, a body whose frame has the world's directions and its origin at
/// `pivot`, in the frame of the tag.
Body& put_on_plate(World& world, PlacedTag& tag, const Eigen::Vector3d& pivot) {
  const Pose T_world_tag = world.T_world_tag(tag, 0.0);
  const Pose T_tag_pivot(T_world_tag.rotation().conjugate(), pivot);
  Body plate{.name = "plate", .T_world_body = {}, .panels = {}};
  const Pose T_world_pivot = T_world_tag * T_tag_pivot;
  for (std::size_t axis = 0; axis < 3; ++axis)
    plate.T_world_body.position_m[axis].offset = T_world_pivot.translation()[static_cast<Eigen::Index>(axis)];
  tag.T_body_tag = T_tag_pivot.inverse();
  const double half_m = print_half_m(world, tag);
  constexpr double kBehind_m = 0.0005;
  add_plate(plate, tag.T_body_tag * Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, kBehind_m}),
            {half_m, half_m}, world.print.paper);
  tag.body = world.scene.bodies.size();
  world.scene.bodies.push_back(plate);
  return world.scene.bodies.back();
}

/// The sizes file states 3 to 15 % too much or too little.
bool state_wrong_size(World& world, const Culprit& culprit, Draw& draw) {
  const double share = draw.sign() * draw.log_uniform(0.03, 0.15);
  world.stated_sizes_m[world.tags[culprit.tag].key] *= 1.0 + share;
  world.drawn["fault"]["share"] = share;
  return true;
}

/// Makes the body turn by its roll about `axis`, a direction of the world, while its frame keeps the world's
/// directions.
void turn_about(Motion& motion, const Eigen::Vector3d& axis) {
  motion.yaw_rad.offset = std::atan2(axis.y(), axis.x());
  motion.pitch_rad.offset = -std::asin(std::clamp(axis.z(), -1.0, 1.0));
  const Eigen::Quaterniond R_world_axis =
      Eigen::Quaterniond(Eigen::AngleAxisd(motion.yaw_rad.offset, Eigen::Vector3d::UnitZ())) *
      Eigen::Quaterniond(Eigen::AngleAxisd(motion.pitch_rad.offset, Eigen::Vector3d::UnitY()));
  motion.T_end = Pose(R_world_axis.conjugate(), Eigen::Vector3d::Zero());
}

/// Between two of its views it is hung 3 to 40 cm aside, or turned by 5 to 40 degrees in its plane, or both.
bool move_once(World& world, const Culprit& culprit, Draw& draw) {
  PlacedTag& tag = world.tags[culprit.tag];
  const Eigen::Quaterniond R_world_tag = world.T_world_tag(tag, 0.0).rotation();
  const int what = draw.integer(0, 2);
  const double metres = what == 1 ? 0.0 : std::min(draw.log_uniform(0.03, 0.4), 4.0 * tag.size_m);
  const double radians = what == 0 ? 0.0 : draw.sign() * draw.log_uniform(5.0, 40.0) * pi / 180.0;
  const auto views = static_cast<int>(culprit.times_s.size());
  const int after = draw.integer(kLeastViewsPerPlace, views - kLeastViewsPerPlace);
  const double when_s = culprit.times_s[static_cast<std::size_t>(after)] - 0.5 / world.scene.rate_hz;
  const double direction = draw.uniform(0.0, 2.0 * pi);
  const Eigen::Vector3d way =
      R_world_tag * Eigen::Vector3d(metres * std::cos(direction), metres * std::sin(direction), 0.0);
  const double width_s = 0.02 / world.scene.rate_hz;  // done between two frames
  Motion& motion = put_on_plate(world, tag, Eigen::Vector3d::Zero()).T_world_body;
  turn_about(motion, R_world_tag * Eigen::Vector3d::UnitZ());
  for (std::size_t i = 0; i < 3; ++i)
    motion.position_m[i].steps = {{way[static_cast<Eigen::Index>(i)], when_s, width_s}};
  motion.roll_rad.steps = {{radians, when_s, width_s}};
  world.drawn["fault"].update({{"moved_m", metres}, {"turned_rad", radians}, {"when_s", when_s}});
  return true;
}

/// It hangs by its upper border and swings 2 to 8 degrees rms, and 2 to 10 mm aside.
bool hang_loose(World& world, const Culprit& culprit, Draw& draw) {
  PlacedTag& tag = world.tags[culprit.tag];
  const Eigen::Quaterniond R_world_tag = world.T_world_tag(tag, 0.0).rotation();
  const double radians = draw.log_uniform(2.0, 8.0) * pi / 180.0;
  const double metres = draw.log_uniform(0.002, 0.010);
  const Eigen::Vector3d upper_border(0.0, -print_half_m(world, tag), 0.0);
  Motion& motion = put_on_plate(world, tag, upper_border).T_world_body;
  turn_about(motion, R_world_tag * Eigen::Vector3d::UnitX());
  const auto swing = [&](double rms) {
    return std::vector<Wave>{{rms, draw.uniform(0.3, 0.6), draw.uniform(0.0, 2.0 * pi)},
                             {rms, draw.uniform(0.7, 1.4), draw.uniform(0.0, 2.0 * pi)}};
  };
  motion.roll_rad.waves = swing(radians);
  for (Channel& channel : motion.position_m) channel.waves = swing(metres / std::numbers::sqrt3);
  world.drawn["fault"].update({{"swing_rad", radians}, {"aside_m", metres}});
  return true;
}

/// Rolled about its upright middle line by 12 to 45 degrees from border to border, or twisted by 5 to 20.
bool bend_print(World& world, const Culprit& culprit, Draw& draw) {
  PlacedTag& tag = world.tags[culprit.tag];
  Bend bend;
  if (draw.chance(0.5)) {
    bend.curl_rad = draw.sign() * draw.log_uniform(12.0, 45.0) * pi / 180.0;
  } else {
    bend.twist_rad = draw.sign() * draw.log_uniform(5.0, 20.0) * pi / 180.0;
  }
  bend.width_m = 2.0 * print_half_m(world, tag);
  tag.bend = bend;
  // Its borders that go backwards must not dive into the wall, before which it is hung by so much.
  const double proud_m = 0.5 * bend.width_m *
                         std::max(-std::sin(0.25 * bend.curl_rad), std::sin(0.5 * std::abs(bend.twist_rad)));
  tag.T_body_tag =
      tag.T_body_tag * Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, -std::max(proud_m, 0.0) - 0.002});
  world.drawn["fault"].update({{"curl_rad", bend.curl_rad}, {"twist_rad", bend.twist_rad}});
  return true;
}

/// Another joined tag of the same family carries its id and size, too: 0.3 m and more away and 4 sizes.
bool print_twice(World& world, const Culprit& culprit, const std::vector<Culprit>& others, Draw& draw) {
  const PlacedTag& tag = world.tags[culprit.tag];
  const Eigen::Vector3d place = world.T_world_tag(tag, 0.0).translation();
  std::vector<std::size_t> choices;
  for (const Culprit& other : others) {
    const PlacedTag& second = world.tags[other.tag];
    const double apart = (world.T_world_tag(second, 0.0).translation() - place).norm();
    // No larger than what hung there, so that it overlaps nothing.
    if (second.key.family == tag.key.family && second.size_m >= 0.7 * tag.size_m &&
        apart > std::max(0.3, 4.0 * tag.size_m))
      choices.push_back(other.tag);
  }
  if (choices.empty()) return false;
  PlacedTag& copy =
      world.tags[choices[static_cast<std::size_t>(draw.integer(0, static_cast<int>(choices.size()) - 1))]];
  world.stated_sizes_m.erase(copy.key);
  world.drawn["fault"].update({{"in_place_of", to_string(copy.key)}});
  copy.key = tag.key;
  copy.size_m = std::min(copy.size_m, tag.size_m);
  const double stated = copy.size_m;
  world.tags[culprit.tag].size_m = stated;
  world.stated_sizes_m[tag.key] = stated;
  copy.is_copy = true;
  return true;
}

/// fx and fy of the camera file are 2 to 8 % too large or too small.
bool state_wrong_focal_length(World& world, Draw& draw) {
  const double share = draw.sign() * draw.log_uniform(0.02, 0.08);
  Pinhole pinhole = world.stated_camera.model.pinhole();
  pinhole.fx *= 1.0 + share;
  pinhole.fy *= 1.0 + share;
  world.stated_camera.model = CameraModel(pinhole, world.stated_camera.model.distortion());
  world.drawn["fault"].update({{"share", share}});
  return true;
}

/// The camera file is of another crop: its principal point is 2 to 10 % of the picture's width away.
bool state_other_crop(World& world, Draw& draw) {
  Pinhole pinhole = world.stated_camera.model.pinhole();
  const double off_px = draw.log_uniform(0.02, 0.10) * world.stated_camera.width;
  const double direction = draw.uniform(0.0, 2.0 * pi);
  pinhole.cx += off_px * std::cos(direction);
  pinhole.cy += off_px * std::sin(direction);
  world.stated_camera.model = CameraModel(pinhole, world.stated_camera.model.distortion());
  world.drawn["fault"].update({{"off_px", off_px}, {"direction_rad", direction}});
  return true;
}

/// Whether the tag hangs still, so that it can be given a motion of its own.
bool is_at_rest(const World& world, const Culprit& culprit) {
  return world.scene.bodies[world.tags[culprit.tag].body].T_world_body.is_fixed();
}

bool plant_on(World& world, const Culprit& culprit, const std::vector<Culprit>& all, Draw& draw) {
  switch (world.fault) {
    case FaultKind::kWrongSize:
      return state_wrong_size(world, culprit, draw);
    case FaultKind::kMoved:
      return is_at_rest(world, culprit) && move_once(world, culprit, draw);
    case FaultKind::kBent:
      return bend_print(world, culprit, draw);
    case FaultKind::kLoose:
      return is_at_rest(world, culprit) && hang_loose(world, culprit, draw);
    default:
      return print_twice(world, culprit, all, draw);
  }
}

}  // namespace

bool plant_fault(World& world, std::uint64_t attempt) {
  Draw draw(world.seed, Part::kFault, attempt);
  world.drawn["fault"] = {{"kind", to_string(world.fault)}};
  if (world.fault == FaultKind::kNone) return true;
  if (world.fault == FaultKind::kFocalLength) return state_wrong_focal_length(world, draw);
  if (world.fault == FaultKind::kCameraFile) return state_other_crop(world, draw);
  const std::vector<Culprit> all = candidates(world);
  if (all.size() < kLeastCandidates) return false;
  const Culprit& culprit = all[static_cast<std::size_t>(draw.integer(0, static_cast<int>(all.size()) - 1))];
  const TagKey key = world.tags[culprit.tag].key;
  if (!plant_on(world, culprit, all, draw)) return false;
  world.culprits = {key};
  return true;
}

}  // namespace apriltrack::worlds
