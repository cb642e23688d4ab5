#include "blur_film.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "apriltrack/base/random.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/sim/streaks.h"
#include "apriltrack/tags/tag_corners.h"

namespace apriltrack::test {
namespace {

constexpr double kFilmTagSize_m = 0.16;
constexpr double kExposure_s = 0.024;

Camera small_camera(double focal_px) {
  Camera camera{.model = CameraModel({focal_px, focal_px, 159.5, 119.5}, NoDistortion{})};
  camera.width = 320;
  camera.height = 240;
  camera.exposure_s = kExposure_s;
  return camera;
}

MapTag film_tag(int id, const Pose& T_map_tag) {
  MapTag tag;
  tag.key = {"tag36h11", id};
  tag.size_m = kFilmTagSize_m;
  tag.T_map_tag = T_map_tag;
  return tag;
}

/// Patches of 8 cm of random grey: a wall with things on it.
std::shared_ptr<const Texture> patchwork(std::uint64_t seed, int size) {
  RandomStream random(seed);
  Image<float> image(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) image(x, y) = static_cast<float>(random.uniform(0.25, 0.6));
  }
  return std::make_shared<Texture>(std::move(image), 0.08);
}

Room patchwork_room(const Eigen::Vector3d& min_corner, const Eigen::Vector3d& max_corner) {
  Room room;
  room.min_corner = min_corner;
  room.max_corner = max_corner;
  for (std::size_t i = 0; i < room.radiance.size(); ++i) room.radiance[i] = patchwork(i, 64);
  return room;
}

Scene waved_scene(double amplitude_m) {
  Scene scene;
  scene.truth = TruthKind::kJoint;
  scene.camera = small_camera(400.0);
  scene.room = patchwork_room({-2.5, -2.5, -1.0}, {2.5, 2.5, 2.0});
  scene.map.tags = {film_tag(5, Pose())};
  Motion motion;
  motion.T_end = {rotation_exp({0.35, 0.2, 0.1}), Eigen::Vector3d::Zero()};
  motion.position_m[2].offset = 0.62;
  motion.position_m[0].waves = {{0.02, 0.6, 0.3}};
  motion.position_m[1].waves = {{0.015, 0.8, 1.0}};
  motion.position_m[0].bursts = {
      {.amplitude = amplitude_m, .centre_s = 0.55, .width_s = 0.12, .frequency_hz = 2.6}};
  motion.position_m[1].bursts = {
      {.amplitude = 0.6 * amplitude_m, .centre_s = 0.6, .width_s = 0.12, .frequency_hz = 2.2}};
  motion.yaw_rad.bursts = {{.amplitude = 0.6, .centre_s = 0.55, .width_s = 0.12, .frequency_hz = 2.2}};
  Body body{.name = "tag", .T_world_body = motion, .panels = {}};
  add_tags(body, scene.map, {.margin_cells = 0.5});
  scene.bodies = {body};
  scene.exposure_s = kExposure_s;
  scene.num_frames = 24;
  scene.start_ns = 250'000'000;
  return scene;
}

Scene far_scene() {
  Scene scene = waved_scene(0.0);
  Motion motion;
  motion.T_end = {rotation_exp({0.3, 0.2, 0.1}), Eigen::Vector3d::Zero()};
  motion.position_m[2].offset = 2.2;
  scene.bodies[0].T_world_body = motion;
  scene.exposure_s = 0.004;
  scene.camera.exposure_s = 0.004;
  scene.num_frames = 5;
  return scene;
}

/// As far_tag(), nearer, and for longer.
Scene still_scene() {
  Scene scene = far_scene();
  scene.bodies[0].T_world_body.position_m[2].offset = 1.2;
  scene.num_frames = 30;
  return scene;
}

Scene shaken_scene() {
  Scene scene;
  scene.truth = TruthKind::kEgo;
  scene.camera = small_camera(300.0);
  scene.room = patchwork_room({-2.5, -2.5, -2.0}, {2.5, 2.5, 1.5});
  // Walls before the camera (z = 1.5) and to its right, as it stands at the origin.
  scene.map.tags = {film_tag(3, {Eigen::Quaterniond::Identity(), {-0.25, -0.1, 1.1}}),
                    film_tag(8, {rotation_exp({0.0, 0.0, 0.2}), {0.1, 0.15, 1.1}}),
                    film_tag(11, {rotation_exp({0.0, 0.7, 0.0}), {0.4, -0.15, 1.0}})};
  Motion motion;
  motion.position_m[0].waves = {{0.04, 0.7, 0.0}};
  motion.position_m[1].waves = {{0.03, 0.5, 1.0}};
  motion.yaw_rad.bursts = {{.amplitude = 0.25, .centre_s = 0.55, .width_s = 0.12, .frequency_hz = 2.5}};
  motion.pitch_rad.bursts = {{.amplitude = 0.2, .centre_s = 0.6, .width_s = 0.12, .frequency_hz = 2.8}};
  motion.roll_rad.bursts = {{.amplitude = 0.15, .centre_s = 0.5, .width_s = 0.12, .frequency_hz = 2.0}};
  scene.T_world_camera = motion;
  Body walls{.name = "walls", .T_world_body = Motion::fixed(Pose()), .panels = {}};
  add_tags(walls, scene.map, {.margin_cells = 0.5});
  scene.bodies = {walls};
  scene.exposure_s = kExposure_s;
  scene.num_frames = 24;
  scene.start_ns = 250'000'000;
  return scene;
}

Scene swung_scene() {
  Scene scene = shaken_scene();
  Motion motion;
  constexpr double kFramesOfSwing = 9.5;
  motion.pitch_rad.waves = {{0.3, 30.0 / kFramesOfSwing, 0.5 * std::numbers::pi}};
  scene.T_world_camera = motion;
  scene.start_ns = 0;
  scene.num_frames = 16;
  return scene;
}

}  // namespace

BlurFilm::BlurFilm(Scene filmed, std::uint64_t noise_seed) : scene(std::move(filmed)) {
  const Renderer renderer(scene, {.seed = noise_seed});
  DetectorOptions options;
  options.families = {scene.map.tags.front().key.family};
  options.response = scene.camera.response;
  Detector detector(options);
  for (std::size_t i = 0; i < scene.num_frames; ++i) {
    frames.push_back(renderer.render(i));
    const Timestamp time = frames.back().timestamp;
    detections.push_back(detector.detect(frames.back().pixels.view()));
    blur_px.push_back(frame_blur_px(scene, time).value_or(0.0));
  }
}

double BlurFilm::corner_error_px(std::size_t index, const Pose& pose) const {
  const auto view = [&](const Pose& p) { return scene.truth == TruthKind::kEgo ? p.inverse() : p; };
  const Pose estimate = view(pose), truth = view(frames[index].truth);
  double sum = 0.0;
  int count = 0;
  for (const TagView& seen : tag_views(scene, frames[index].timestamp)) {
    const auto tag = std::find_if(scene.map.tags.begin(), scene.map.tags.end(),
                                  [&](const MapTag& candidate) { return candidate.key == seen.key; });
    for (const Eigen::Vector3d& corner : tag_corners(tag->size_m)) {
      const Eigen::Vector3d point = tag->T_map_tag * corner;
      const auto found = scene.camera.model.project(estimate * point);
      const auto expected = scene.camera.model.project(truth * point);
      sum += found && expected ? (*found - *expected).norm() : 1e3;
      ++count;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

const BlurFilm& waved_tag() {
  static const BlurFilm film(waved_scene(0.11), 1);
  return film;
}

const BlurFilm& far_tag() {
  static const BlurFilm film(far_scene(), 4);
  return film;
}

const BlurFilm& still_tag() {
  static const BlurFilm film(still_scene(), 6);
  return film;
}

const BlurFilm& wild_tag() {
  static const BlurFilm film(waved_scene(0.32), 3);
  return film;
}

const BlurFilm& swung_camera() {
  static const BlurFilm film = swung_camera_with(5);
  return film;
}

BlurFilm swung_camera_with(std::uint64_t seed) {
  return {swung_scene(), seed};
}

const BlurFilm& shaken_camera() {
  static const BlurFilm film(shaken_scene(), 2);
  return film;
}

BlurTracker tracker_of(const BlurFilm& film, std::uint64_t seed, int num_particles) {
  BlurTrackerOptions options;
  options.num_particles = num_particles;
  options.mode = film.scene.truth == TruthKind::kEgo ? TrackMode::kEgo : TrackMode::kJoint;
  options.seed = seed;
  return {film.scene.camera, film.scene.map, options};
}

std::vector<TrackResult> tracked(BlurTracker tracker, const BlurFilm& film, std::size_t first) {
  std::vector<TrackResult> results;
  for (std::size_t i = first; i < film.size(); ++i)
    results.push_back(tracker.track(film.frames[i].frame(), film.detections[i]));
  return results;
}

bool has_evidence(const TrackResult& result) {
  return result.status == TrackStatus::kDetected || result.status == TrackStatus::kTracked;
}

}  // namespace apriltrack::test
