// The lens and the picture's size.
#include <cmath>
#include <numbers>

#include "draw.h"
#include "world.h"

namespace apriltrack::worlds {
namespace {

struct Resolution {
  int width, height;
  double weight;
};
// Large pictures are seldom, for they cost as much time as many small ones.
constexpr Resolution kResolutions[] = {{640, 480, 0.34},   {752, 480, 0.18},  {800, 600, 0.16},
                                       {1024, 768, 0.10},  {1280, 720, 0.09}, {1280, 1024, 0.06},
                                       {1440, 1080, 0.04}, {1920, 1200, 0.03}};
constexpr double kWide_deg = 100.0;  // pinhole formulas end about there
constexpr double kShareOfWide = 0.35;
constexpr double kWidestDiagonal_deg = 170.0;  // the renderer sees up to 87 degrees off the axis
constexpr double kLeastSlope = 0.35;  // of the radtan formula at the corner: flatter ones are no real lens

double degrees_to_rad(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

double equidistant_radius(const std::vector<double>& k, double theta) {
  const double t2 = theta * theta;
  return theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

/// The horizontal field of view that gives the picture's diagonal at most kWidestDiagonal_deg, if that is
/// less.
double within_diagonal(double fov_deg, const Resolution& size) {
  const double diagonal = std::hypot(size.width, size.height) / size.width;
  return std::min(fov_deg, kWidestDiagonal_deg / diagonal);
}

Distortion draw_radtan(Draw& draw, double half_width, double half_diagonal, double& edge) {
  for (;;) {
    const double k1 = draw.uniform(-0.32, 0.06);
    const double k2 = -k1 * draw.uniform(0.2, 0.45);
    const auto slope = [&](double r) { return 1.0 + 3.0 * k1 * r * r + 5.0 * k2 * r * r * r * r; };
    bool is_lens = true;
    for (double r = 0.0; r < 1.15 * half_diagonal; r += 0.05) is_lens = is_lens && slope(r) > kLeastSlope;
    if (!is_lens) continue;
    edge = half_width * (1.0 + k1 * half_width * half_width + k2 * std::pow(half_width, 4));
    return RadtanDistortion({k1, k2, draw.uniform(-1e-3, 1e-3), draw.uniform(-1e-3, 1e-3)});
  }
}

}  // namespace

void draw_lens(World& world, std::uint64_t attempt) {
  Draw draw(world.seed, Part::kLens, attempt);
  double weights[std::size(kResolutions)];
  for (std::size_t i = 0; i < std::size(kResolutions); ++i) weights[i] = kResolutions[i].weight;
  const Resolution& size = kResolutions[draw.weighted(weights)];
  const bool is_wide = draw.chance(kShareOfWide);
  const double fov_deg =
      within_diagonal(is_wide ? draw.uniform(kWide_deg, 140.0) : draw.uniform(60.0, kWide_deg), size);
  const double kind = draw.uniform(0.0, 1.0);
  const double half_rad = 0.5 * degrees_to_rad(fov_deg);
  const double half_width = std::tan(std::min(half_rad, degrees_to_rad(0.5 * kWide_deg)));

  Distortion distortion = NoDistortion{};
  double edge = half_width;  // of the picture's right border on the plane of unit focal length
  if (is_wide || kind < 0.2) {
    const std::vector<double> k = {draw.uniform(-0.04, 0.02), draw.uniform(-0.008, 0.008),
                                   draw.uniform(-0.002, 0.002), draw.uniform(-2e-4, 2e-4)};
    distortion = EquidistantDistortion(k);
    edge = equidistant_radius(k, half_rad);
  } else if (kind < 0.85) {
    distortion =
        draw_radtan(draw, half_width, half_width * std::hypot(size.width, size.height) / size.width, edge);
  }
  const double fx = 0.5 * size.width / edge;
  const double off = 0.02 * size.width;
  const Pinhole pinhole{fx, fx * draw.uniform(0.997, 1.003), 0.5 * (size.width - 1) + draw.uniform(-off, off),
                        0.5 * (size.height - 1) + draw.uniform(-off, off)};
  Camera& camera = world.scene.camera;
  camera.model = CameraModel(pinhole, distortion);
  camera.width = size.width;
  camera.height = size.height;
  world.drawn["lens"] = {{"width", size.width},
                         {"height", size.height},
                         {"model", camera.model.distortion_name()},
                         {"fov_deg", fov_deg},
                         {"focal_px", fx}};
}

}  // namespace apriltrack::worlds
