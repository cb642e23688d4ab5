#include "apriltrack/sim/stress.h"

#include <array>
#include <cmath>
#include <numbers>

#include "apriltrack/base/check.h"
#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

constexpr double kHandDepth_m = 0.25;  // nearer than anything that the named scenes show
constexpr double kSkin = 0.42;         // reflectance

Panel hand_part(double x, double y, double half_width, double half_height) {
  Panel part;
  part.T_body_panel = Pose(Eigen::Quaterniond::Identity(), {x, y, 0.0});
  part.half_size_m = {half_width, half_height};
  part.reflectance = kSkin;
  return part;
}

/// Origin in the middle of the knuckles, fingers towards -y; the parts do not overlap, and lie in one plane.
Body hand(double width_m, double forearm_m) {
  constexpr int kFingers = 4;
  const double finger_m = 0.19 * width_m;
  const double gap_m = (width_m - kFingers * finger_m) / (kFingers - 1);
  constexpr std::array<double, kFingers> kLengths = {0.70, 0.85, 0.90, 0.80};  // of the hand's width
  Body hand{.name = "hand", .T_world_body = {}, .moves_with_camera = true, .panels = {}};
  hand.panels.push_back(hand_part(0.0, 0.5 * width_m, 0.5 * width_m, 0.5 * width_m));
  hand.panels.push_back(hand_part(0.0, width_m + 0.5 * forearm_m, 0.35 * width_m, 0.5 * forearm_m));
  for (int i = 0; i < kFingers; ++i) {
    const double length = kLengths[static_cast<std::size_t>(i)] * width_m;
    const double x = -0.5 * width_m + 0.5 * finger_m + i * (finger_m + gap_m);
    hand.panels.push_back(hand_part(x, -0.5 * length, 0.5 * finger_m, 0.5 * length));
  }
  return hand;
}

Motion to_and_fro(double half_view_x_m, double half_view_y_m, double width_m) {
  constexpr double kLongestFinger = 0.9;
  const double tip_m = -0.7 * half_view_y_m + kLongestFinger * width_m;
  Motion motion;
  motion.position_m[0].waves = {
      {1.35 * half_view_x_m + 0.5 * width_m, 0.37, 4.2}};  // out of view on both sides
  motion.position_m[1] = {
      .offset = tip_m, .rate_per_s = 0.0, .waves = {{0.12 * half_view_y_m, 0.83, 0.0}}, .bursts = {}};
  motion.position_m[2].offset = kHandDepth_m;
  motion.yaw_rad.waves = {{0.15, 0.61, 0.5}};  // in the image's plane
  return motion;
}

constexpr double kSlowest_hz = 0.3;  // slower waves are the way itself, faster ones the shaking of the hand
constexpr double kLongestShift_s = 0.3;

void vary(Channel& channel, RandomStream& random) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (Wave& wave : channel.waves) {
    if (wave.frequency_hz > kSlowest_hz) wave.phase_rad = random.uniform(0.0, kTurn);
  }
  for (Burst& burst : channel.bursts) {
    burst.centre_s += random.uniform(-kLongestShift_s, kLongestShift_s);
    if (burst.frequency_hz > 0.0) burst.phase_rad = random.uniform(0.0, kTurn);
  }
}

void vary(Motion& motion, RandomStream random) {
  for (Channel& channel : motion.position_m) vary(channel, random);
  for (Channel* angle : {&motion.yaw_rad, &motion.pitch_rad, &motion.roll_rad}) vary(*angle, random);
}

}  // namespace

void add_passing_hand(Scene& scene, double share_of_width) {
  APRILTRACK_CHECK(share_of_width > 0.0 && share_of_width <= 1.0, "share_of_width must lie in (0, 1]");
  const Pinhole& lens = scene.camera.model.pinhole();
  const double half_view_x_m = kHandDepth_m * 0.5 * scene.camera.width / lens.fx;
  const double half_view_y_m = kHandDepth_m * 0.5 * scene.camera.height / lens.fy;
  const double width_m = share_of_width * 2.0 * half_view_x_m;
  Body before_lens = hand(width_m, 4.0 * half_view_y_m);
  before_lens.T_world_body = to_and_fro(half_view_x_m, half_view_y_m, width_m);
  scene.bodies.push_back(before_lens);
}

void vary_motion(Scene& scene, std::uint64_t take) {
  constexpr std::uint64_t kOwnNumbers = 0x7461'6b65;  // not those of the noise
  vary(scene.T_world_camera, RandomStream(take, kOwnNumbers, 0));
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    vary(scene.bodies[i].T_world_body, RandomStream(take, kOwnNumbers, i + 1));
}

}  // namespace apriltrack
