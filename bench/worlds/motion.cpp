// The way of the camera, or of the box that is turned before it: past glances from which tags are seen
// together.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "draw.h"
#include "places.h"
#include "truth.h"

namespace apriltrack::worlds {
namespace {

using std::numbers::pi;

enum class Carrier { kHand, kCart, kDrone, kTripod };
constexpr const char* kCarrierNames[] = {"hand", "cart", "drone", "tripod"};

constexpr int kGlances = 260;
constexpr double kFromWalls_m = 0.25;
constexpr double kSteepest_rad = 1.25;  // looking down: yaw and roll become one beyond
// Frames of a recording: as many as take the renderer some ten seconds (bench/worlds/README.md).
constexpr double kPixelsPerRecording = 45e6;
constexpr int kLeastFrames = 50, kMostFrames = 120;
constexpr double kSlowest_hz = 2.0, kFastest_hz = 15.0;

struct Glance {
  Eigen::Vector3d eye;
  double yaw = 0.0, pitch = 0.0, roll = 0.0;
  std::vector<std::size_t> tags;  ///< That it shows well.

  Pose T_world_camera() const {
    Motion motion;
    for (int i = 0; i < 3; ++i) motion.position_m[static_cast<std::size_t>(i)].offset = eye[i];
    motion.yaw_rad.offset = yaw;
    motion.pitch_rad.offset = pitch;
    motion.roll_rad.offset = roll;
    motion.T_end = camera_looking_along_x();
    return motion.at(0.0);
  }
};

/// How a carrier moves.
struct Gait {
  double speed_m_s, turn_rad_s;
  double flow;           ///< Width of a step, in shares of its time: little is rest, move, rest.
  double low_m, high_m;  ///< Of the camera over the floor.
};

Gait gait_of(Carrier carrier, const World& world, Draw& draw) {
  const double top = world.room_size_m.z() - kFromWalls_m;
  switch (carrier) {
    case Carrier::kHand:
      return {0.7, 0.9, 0.35, 0.9, std::min(1.8, top)};
    case Carrier::kCart: {
      const double height = draw.uniform(0.4, 1.3);
      return {0.5, 0.6, 0.40, height, height};
    }
    case Carrier::kDrone:
      return {1.0, 0.8, 0.40, 0.5, top};
    default:
      return {0.6, 0.8, 0.10, 1.1, 1.6};
  }
}

double wrapped(double angle) {
  return angle - 2.0 * pi * std::round(angle / (2.0 * pi));
}

void look_along(Glance& glance, const Eigen::Vector3d& direction) {
  glance.yaw = std::atan2(direction.y(), direction.x());
  glance.pitch = std::clamp(-std::asin(direction.z() / direction.norm()), -kSteepest_rad, kSteepest_rad);
}

/// A place before one tag, from which the camera looks between it and one near to it.
std::optional<Glance> glance_at(const World& world, const Gait& gait, Draw& draw) {
  const int last = static_cast<int>(world.tags.size()) - 1;
  const PlacedTag& first = world.tags[static_cast<std::size_t>(draw.integer(0, last))];
  const Pose T_world_first = world.T_world_tag(first, 0.0);
  std::vector<std::pair<double, Eigen::Vector3d>> others;
  for (const PlacedTag& other : world.tags) {
    const Eigen::Vector3d place = world.T_world_tag(other, 0.0).translation();
    others.emplace_back((place - T_world_first.translation()).norm(), place);
  }
  std::ranges::sort(others, {}, &std::pair<double, Eigen::Vector3d>::first);
  const Eigen::Vector3d second =
      others[static_cast<std::size_t>(draw.integer(std::min(1, last), std::min(5, last)))].second;

  const double side_px = draw.log_uniform(16.0, 130.0);
  const double distance =
      std::clamp(world.scene.camera.model.pinhole().fx * first.size_m / side_px, 0.15, 6.0);
  const Eigen::Vector3d away =
      -(T_world_first.rotation() * Eigen::Vector3d::UnitZ()) + 0.7 * draw.normal_vector();
  Glance glance;
  glance.eye = T_world_first.translation() + distance * away.normalized();
  glance.eye = glance.eye.array().max(kFromWalls_m).min(world.room_size_m.array() - kFromWalls_m);
  glance.eye.z() = std::clamp(glance.eye.z(), gait.low_m, gait.high_m);
  if (is_in_solid(world, glance.eye, kFromWalls_m)) return std::nullopt;
  const Eigen::Vector3d to_first = T_world_first.translation() - glance.eye;
  const Eigen::Vector3d to_second = second - glance.eye;
  look_along(glance, to_first.normalized() + draw.uniform(0.4, 1.0) * to_second.normalized() +
                         0.1 * draw.normal_vector());
  glance.roll = 0.08 * draw.normal();
  return glance;
}

void look_at_tags(const World& world, Glance& glance) {
  for (const TrueView& view : views_from(world, glance.T_world_camera(), 0.0)) {
    if (view.is_good()) glance.tags.push_back(view.tag);
  }
}

std::vector<Glance> glances_of(const World& world, const Gait& gait, Draw& draw) {
  std::vector<Glance> glances;
  for (int i = 0; i < kGlances; ++i) {
    std::optional<Glance> glance = glance_at(world, gait, draw);
    if (!glance) continue;
    look_at_tags(world, *glance);
    if ((*glance).tags.size() >= 2) glances.push_back(*std::move(glance));
  }
  return glances;
}

/// First those that join as many tags as can be joined, each with as many new ones as possible; then any.
std::vector<Glance> chosen_glances(std::vector<Glance> glances, std::size_t count, std::size_t num_tags) {
  std::vector<Glance> chosen;
  std::vector<bool> is_reached(num_tags, false);
  const auto gain = [&](const Glance& glance) {
    const auto known = std::ranges::count_if(glance.tags, [&](std::size_t tag) { return is_reached[tag]; });
    const auto fresh = static_cast<std::ptrdiff_t>(glance.tags.size()) - known;
    return chosen.empty() || known > 0 ? fresh : std::ptrdiff_t{0};
  };
  while (!glances.empty()) {
    auto best = std::ranges::max_element(glances, {}, gain);
    if (gain(*best) == 0) {
      if (chosen.size() >= count) break;
      best = glances.begin();
    }
    for (const std::size_t tag : (*best).tags) is_reached[tag] = true;
    chosen.push_back(*best);
    glances.erase(best);
  }
  return chosen;
}

double apart(const Glance& a, const Glance& b) {
  return (a.eye - b.eye).norm() + std::abs(wrapped(a.yaw - b.yaw)) + std::abs(a.pitch - b.pitch);
}

/// Each followed by the nearest that is left.
std::vector<Glance> as_tour(std::vector<Glance> left) {
  std::vector<Glance> tour = {left.front()};
  left.erase(left.begin());
  while (!left.empty()) {
    const auto next =
        std::ranges::min_element(left, {}, [&](const Glance& g) { return apart(tour.back(), g); });
    tour.push_back(*next);
    left.erase(next);
  }
  return tour;
}

/// A channel that goes from value to value, each leg in its time.
Channel through(const std::vector<double>& values, const std::vector<double>& leg_s, double flow) {
  Channel channel{.offset = values.front(), .rate_per_s = 0.0, .waves = {}, .bursts = {}};
  double time_s = 0.0;
  for (std::size_t i = 0; i < leg_s.size(); ++i) {
    const double change = values[i + 1] - values[i];
    if (change != 0.0) channel.steps.push_back({change, time_s + 0.5 * leg_s[i], flow * leg_s[i]});
    time_s += leg_s[i];
  }
  return channel;
}

std::vector<double> leg_times(const std::vector<Glance>& tour, const Gait& gait) {
  constexpr double kLeastLeg_s = 0.5;
  std::vector<double> leg_s;
  for (std::size_t i = 0; i + 1 < tour.size(); ++i) {
    const double way_s = (tour[i + 1].eye - tour[i].eye).norm() / gait.speed_m_s;
    const double turn = std::max(std::abs(wrapped(tour[i + 1].yaw - tour[i].yaw)),
                                 std::abs(tour[i + 1].pitch - tour[i].pitch));
    leg_s.push_back(std::max({kLeastLeg_s, way_s, turn / gait.turn_rad_s}));
  }
  return leg_s;
}

Motion motion_along(const std::vector<Glance>& tour, const std::vector<double>& leg_s, double flow) {
  Motion motion;
  std::vector<double> yaw = {tour.front().yaw};
  for (std::size_t i = 1; i < tour.size(); ++i) yaw.push_back(yaw.back() + wrapped(tour[i].yaw - yaw.back()));
  const auto values = [&](auto get) {
    std::vector<double> all;
    for (const Glance& glance : tour) all.push_back(get(glance));
    return all;
  };
  for (int axis = 0; axis < 3; ++axis) {
    motion.position_m[static_cast<std::size_t>(axis)] =
        through(values([&](const Glance& g) { return g.eye[axis]; }), leg_s, flow);
  }
  motion.yaw_rad = through(yaw, leg_s, flow);
  motion.pitch_rad = through(values([](const Glance& g) { return g.pitch; }), leg_s, flow);
  motion.roll_rad = through(values([](const Glance& g) { return g.roll; }), leg_s, flow);
  return motion;
}

/// Amplitudes of a hand: physiological tremor and steps; of a cart: a floor; of a drone: rotors and gusts.
void add_shake(Motion& motion, Carrier carrier, Draw& draw) {
  struct Shake {
    double position_m, angle_rad, low_hz, high_hz;
  };
  static constexpr Shake kShakes[] = {
      {0.008, 0.012, 0.8, 3.0}, {0.001, 0.002, 4.0, 12.0}, {0.02, 0.01, 0.3, 1.2}, {0, 0, 1, 2}};
  const Shake& shake = kShakes[static_cast<std::size_t>(carrier)];
  if (shake.position_m == 0.0) return;
  const auto add = [&](Channel& channel, double amplitude) {
    for (int i = 0; i < 2; ++i)
      channel.waves.push_back({amplitude * draw.uniform(0.3, 1.0),
                               draw.log_uniform(shake.low_hz, shake.high_hz), draw.uniform(0.0, 2.0 * pi)});
  };
  for (Channel& channel : motion.position_m) add(channel, shake.position_m);
  for (Channel* angle : {&motion.yaw_rad, &motion.pitch_rad, &motion.roll_rad}) add(*angle, shake.angle_rad);
  if (carrier == Carrier::kDrone) motion.roll_rad.waves.push_back({5e-4, draw.uniform(40.0, 80.0), 0.0});
}

/// Frames, rate and exposure for a way of so many seconds.
void set_timing(World& world, double way_s, Draw& draw) {
  Scene& scene = world.scene;
  const double affordable = kPixelsPerRecording / (scene.camera.width * scene.camera.height);
  scene.num_frames =
      static_cast<std::size_t>(std::clamp(static_cast<int>(affordable), kLeastFrames, kMostFrames));
  scene.rate_hz = std::clamp(static_cast<double>(scene.num_frames) / way_s, kSlowest_hz, kFastest_hz);
  const double stretch = way_s * scene.rate_hz / static_cast<double>(scene.num_frames);
  scene.T_world_camera.speed = stretch;  // the whole way in the frames that there are
  if (scene.truth == TruthKind::kJoint) scene.bodies[scene.truth_body].T_world_body.speed = stretch;
  // The exposure that gives tags in view this median blur; cameras choose it by light, which is drawn to fit.
  const double wanted_px = draw.log_uniform(0.15, 1.2);
  scene.exposure_s = 1e-3;
  std::vector<double> blurs;
  for (const auto& views : all_views(world)) {
    for (const TrueView& view : views) blurs.push_back(view.blur_px);
  }
  if (blurs.empty()) return;
  std::ranges::nth_element(blurs, blurs.begin() + static_cast<std::ptrdiff_t>(blurs.size() / 2));
  scene.exposure_s = std::clamp(1e-3 * wanted_px / std::max(blurs[blurs.size() / 2], 1e-3), 2e-4, 12e-3);
}

/// A box turned to and fro before a camera on a tripod; truth is T_camera_body.
void turn_box_before_camera(World& world, Draw& draw) {
  Scene& scene = world.scene;
  scene.truth = TruthKind::kJoint;
  scene.truth_body = world.surfaces.back().body;
  for (Body& body : scene.bodies) {  // a hand holds the box now
    if (body.name == "stand") body.panels.clear();
  }
  const Eigen::Vector3d eye(kFromWalls_m, 0.5 * world.room_size_m.y(), 1.2);
  Motion camera = Motion::fixed(Pose(camera_looking_along_x().rotation(), eye));
  scene.T_world_camera = camera;
  double radius = 0.0;
  for (const Surface& side : world.surfaces) {
    if (side.body == scene.truth_body)
      radius =
          std::max(radius, std::hypot(side.T_body_surface.translation().norm(), side.half_size_m.norm()));
  }
  const double in_view = draw.uniform(0.5, 0.9) * 0.5 * scene.camera.height;
  const double distance =
      std::min(std::max(radius * scene.camera.model.pinhole().fy / in_view, 1.3 * radius + 0.1),
               world.room_size_m.x() - 2.0 * kFromWalls_m);
  std::vector<Glance> keys;
  double yaw = 0.0;
  const int count = draw.integer(12, 18);
  for (int i = 0; i < count; ++i) {
    Glance key;
    key.eye = eye + Eigen::Vector3d(distance, 0.0, 0.0) +
              0.12 * distance * draw.normal_vector().cwiseMax(-1.5).cwiseMin(1.5);
    yaw += draw.uniform(0.5, 0.9);
    key.yaw = yaw;
    key.pitch = (i % 2 == 0 ? 1.0 : -1.0) * draw.uniform(0.2, 1.2);
    key.roll = 0.3 * draw.normal();
    keys.push_back(key);
  }
  const Gait hand{0.5, 0.9, 0.35, 0.0, 0.0};
  const std::vector<double> leg_s = leg_times(keys, hand);
  Motion motion = motion_along(keys, leg_s, hand.flow);
  add_shake(motion, Carrier::kHand, draw);
  scene.bodies[scene.truth_body].T_world_body = motion;
  double way_s = 0.0;
  for (const double leg : leg_s) way_s += leg;
  set_timing(world, way_s, draw);
  world.drawn["motion"] = {{"carrier", "tripod, the box is turned by hand"}, {"distance_m", distance}};
}

bool is_clear(const World& world) {
  constexpr double kClear_m = 0.12;
  for (std::size_t i = 0; i < world.scene.num_frames; ++i) {
    const double time_s = seconds_between(Timestamp{}, world.scene.timestamp(i));
    if (is_in_solid(world, world.scene.T_world_camera.at(time_s).translation(), kClear_m)) return false;
  }
  return true;
}

}  // namespace

bool draw_motion(World& world, std::uint64_t attempt) {
  Draw draw(world.seed, Part::kMotion, attempt);
  if (world.kind == WorldKind::kBody && draw.chance(0.5)) {
    turn_box_before_camera(world, draw);
    return true;
  }
  const bool is_near_work = world.kind == WorldKind::kDesk || world.kind == WorldKind::kBody;
  const double weights[] = {0.5, is_near_work ? 0.0 : 0.2, 0.2, 0.1};
  const auto carrier = static_cast<Carrier>(draw.weighted(weights));
  const Gait gait = gait_of(carrier, world, draw);
  const std::size_t least = static_cast<std::size_t>(draw.integer(4, 10));
  std::vector<Glance> glances = glances_of(world, gait, draw);
  if (glances.size() < least) return false;
  const std::vector<Glance> tour = as_tour(chosen_glances(std::move(glances), least, world.tags.size()));
  const std::vector<double> leg_s = leg_times(tour, gait);
  double way_s = 0.0;
  for (const double leg : leg_s) way_s += leg;
  world.scene.T_world_camera = motion_along(tour, leg_s, gait.flow);
  world.scene.T_world_camera.T_end = camera_looking_along_x();
  add_shake(world.scene.T_world_camera, carrier, draw);
  set_timing(world, way_s, draw);
  world.drawn["motion"] = {{"carrier", kCarrierNames[static_cast<std::size_t>(carrier)]},
                           {"glances", tour.size()},
                           {"rate_hz", world.scene.rate_hz},
                           {"frames", world.scene.num_frames},
                           {"exposure_s", world.scene.exposure_s}};
  return is_clear(world);
}

}  // namespace apriltrack::worlds
