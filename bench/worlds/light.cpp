// Light: a lamp and what comes from all sides, gloss of prints; and the sensor that it falls on.
#include <algorithm>
#include <cmath>

#include "draw.h"
#include "places.h"

namespace apriltrack::worlds {
namespace {

/// Irradiance of each tag's middle.
std::vector<double> light_on_tags(const World& world) {
  std::vector<double> light;
  for (const PlacedTag& tag : world.tags) {
    const Pose T = world.T_world_tag(tag, 0.0);
    light.push_back(
        world.scene.lighting.irradiance(T.translation(), -(T.rotation() * Eigen::Vector3d::UnitZ())));
  }
  return light;
}

ResponseCurve draw_response(Draw& draw) {
  const double kind = draw.uniform(0.0, 1.0);
  if (kind < 0.7) return ResponseCurve::srgb();
  if (kind < 0.85) return ResponseCurve::gamma(std::round(10.0 * draw.uniform(1.6, 2.4)) / 10.0);
  return ResponseCurve::linear();
}

}  // namespace

void draw_light(World& world, std::uint64_t attempt) {
  Draw draw(world.seed, Part::kLight, attempt);
  const Eigen::Vector3d& size = world.room_size_m;
  Lighting& light = world.scene.lighting;
  light.lamp_world = {draw.uniform(0.2, 0.8) * size.x(), draw.uniform(0.25, 0.75) * size.y(),
                      size.z() - draw.uniform(0.1, 0.4)};
  light.ambient = draw.uniform(0.2, 0.6);
  light.intensity = draw.uniform(0.5, 2.0);
  light.reach_m = draw.uniform(1.5, 5.0);
  if (draw.chance(0.2))
    world.scene.flicker = {
        .depth = draw.uniform(0.05, 0.3), .frequency_hz = 100.0, .phase_rad = draw.uniform(0.0, 6.28)};
  world.drawn["light"] = {{"lamp_m", {light.lamp_world.x(), light.lamp_world.y(), light.lamp_world.z()}},
                          {"ambient", light.ambient},
                          {"intensity", light.intensity},
                          {"reach_m", light.reach_m},
                          {"flicker", world.scene.flicker.depth}};
}

void draw_sensor(World& world, std::uint64_t attempt) {
  Draw draw(world.seed, Part::kSensor, attempt);
  ImageFormation& formation = world.scene.formation;
  // From 0.35 px on a lens takes 13 pictures per frame, and 32 below.
  formation.lens_blur_sigma_px = draw.uniform(0.35, 0.85);
  formation.vignetting = draw.uniform(0.0, 0.5);
  formation.full_well = draw.log_uniform(4000.0, 30000.0);
  formation.read_noise = draw.uniform(3.0, 15.0);
  std::vector<double> light = light_on_tags(world);
  std::ranges::nth_element(light, light.begin() + static_cast<std::ptrdiff_t>(light.size() / 2));
  const double white_level =
      draw.uniform(0.25, 0.8);  // of full scale, of paper in the light of the middle tag
  formation.sensor_gain = white_level / (world.print.paper * light[light.size() / 2]);
  world.scene.camera.response = draw_response(draw);
  world.scene.camera.exposure_s = world.scene.exposure_s;
  world.drawn["sensor"] = {{"lens_blur_sigma_px", formation.lens_blur_sigma_px},
                           {"vignetting", formation.vignetting},
                           {"full_well", formation.full_well},
                           {"read_noise", formation.read_noise},
                           {"white_level", white_level},
                           {"response", world.scene.camera.response.name()}};
}

}  // namespace apriltrack::worlds
