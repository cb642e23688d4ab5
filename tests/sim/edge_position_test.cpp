#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/tags/tag_corners.h"

namespace apriltrack {
namespace {

constexpr double kSize_m = 0.16;
constexpr double kMaxMeanError_px = 0.02;

Scene one_tag(const Pose& T_camera_tag, const CameraModel& model) {
  Scene scene;
  scene.truth = TruthKind::kJoint;
  scene.camera.model = model;
  scene.camera.width = 640;
  scene.camera.height = 480;
  scene.lighting = {.lamp_world = {0, 0, -1000}, .ambient = 1.0, .intensity = 0.0, .reach_m = 1.0};
  scene.formation.vignetting = 0.0;
  MapTag tag;
  tag.key = {"tag36h11", 7};
  tag.size_m = kSize_m;
  scene.map.tags = {tag};
  Body body{.name = "tag", .T_world_body = Motion::fixed(T_camera_tag), .panels = {}};
  add_tags(body, scene.map, {.margin_cells = 0.5, .ink = 0.0, .paper = 1.0});
  scene.bodies = {body};
  return scene;
}

double bilinear(const Image<float>& image, const Eigen::Vector2d& p) {
  const int x = static_cast<int>(std::floor(p.x()));
  const int y = static_cast<int>(std::floor(p.y()));
  const double u = p.x() - x;
  const double v = p.y() - y;
  return (1 - v) * ((1 - u) * image(x, y) + u * image(x + 1, y)) +
         v * ((1 - u) * image(x, y + 1) + u * image(x + 1, y + 1));
}

/// Where a step from dark to bright lies along the normal, by balance of areas: the dark part of a window of
/// half width `reach` is as long as its light says. True for every symmetric blur, whatever its shape.
/// Positive: outside.
double edge_offset_px(const Image<float>& light, const Eigen::Vector2d& on_edge,
                      const Eigen::Vector2d& outward, double reach, double dark, double bright) {
  constexpr int kSteps = 400;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double s = reach * ((i + 0.5) / kSteps * 2.0 - 1.0);
    sum += bilinear(light, on_edge + s * outward);
  }
  const double mean = (sum / kSteps - dark) / (bright - dark);
  return reach * (1.0 - 2.0 * mean);
}

struct Bias {
  double sum = 0.0;
  double sum_squared = 0.0;
  int count = 0;
  void add(double value) {
    sum += value;
    sum_squared += value * value;
    ++count;
  }
  double mean() const { return sum / count; }
  double rms() const { return std::sqrt(sum_squared / count); }
};

/// Corners as meets of the lines through each side's measured edge points, against the projected truth.
class CornerCheck {
 public:
  void add(const Scene& scene, const Image<float>& light) {
    const Pose T = scene.T_camera_map(0.0);
    const auto corners = tag_corners(kSize_m);
    const double cell_px =
        (project(scene, T, corners[0]) - project(scene, T, corners[2])).norm() / (8 * std::sqrt(2.0));
    const double reach = 0.45 * cell_px;  // inside the black border and the white rim
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d a = corners[i];
      const Eigen::Vector3d b = corners[(i + 1) % 4];
      Eigen::Matrix2d normal_matrix = Eigen::Matrix2d::Zero();
      Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
      const Eigen::Vector2d centre = project(scene, T, Eigen::Vector3d::Zero());
      for (double s = 0.15; s <= 0.851; s += 0.01) {
        const Eigen::Vector2d p = project(scene, T, a + s * (b - a));
        const Eigen::Vector2d along = (project(scene, T, a + (s + 0.01) * (b - a)) - p).normalized();
        Eigen::Vector2d outward(along.y(), -along.x());
        if (outward.dot(p - centre) < 0.0) outward = -outward;
        const double offset = edge_offset_px(light, p, outward, reach, 0.0, scene.formation.sensor_gain);
        edges.add(offset);
        const Eigen::Vector2d row(1.0 - s, s);
        normal_matrix += row * row.transpose();
        right_side += offset * row;
      }
      const Eigen::Vector2d ends = normal_matrix.inverse() * right_side;
      at_start_[i] = ends[0];
      at_end_[i] = ends[1];
    }
    for (std::size_t i = 0; i < 4; ++i) {
      corners_.add(at_start_[i]);
      corners_.add(at_end_[i]);
    }
  }

  Bias edges;
  const Bias& corner_offsets() const { return corners_; }

 private:
  static Eigen::Vector2d project(const Scene& scene, const Pose& T, const Eigen::Vector3d& point) {
    return scene.camera.model.project(T * point).value();
  }

  std::array<double, 4> at_start_{};
  std::array<double, 4> at_end_{};
  Bias corners_;
};

void check_edges(const CameraModel& model, double max_offset_m, std::uint64_t seed) {
  RandomStream random(seed);
  CornerCheck check;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d turn{random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6),
                               random.uniform(-3.0, 3.0)};
    const Eigen::Vector3d place{random.uniform(-max_offset_m, max_offset_m),
                                random.uniform(-max_offset_m, max_offset_m), random.uniform(0.7, 1.0)};
    const Scene scene = one_tag(Pose(rotation_exp(turn), place), model);
    check.add(scene, Renderer(scene).sensor_light({0}, 0.004));
  }
  ASSERT_EQ(check.edges.count, 12 * 4 * 71);
  EXPECT_LT(std::abs(check.edges.mean()), 0.25 * kMaxMeanError_px);
  EXPECT_LT(check.edges.rms(), kMaxMeanError_px);
  EXPECT_LT(std::abs(check.corner_offsets().mean()), kMaxMeanError_px);
  EXPECT_LT(check.corner_offsets().rms(), kMaxMeanError_px);
}

TEST(EdgePosition, OfASharpTagIsTheTruth) {
  check_edges(CameraModel(Pinhole{600, 600, 319.5, 239.5}, NoDistortion{}), 0.1, 1);
}

TEST(EdgePosition, OfADistortedTagIsTheTruth) {
  check_edges(
      CameraModel(Pinhole{520.6, 519.4, 322.4, 237.3}, RadtanDistortion({-0.28, 0.09, 0.0005, -0.0003})),
      0.22, 2);
}

/// 52 to 59 degrees off the axis.
TEST(EdgePosition, OfATagFarOffTheAxisOfAFisheyeIsTheTruth) {
  const CameraModel model(Pinhole{262, 262, 319.5, 239.5}, EquidistantDistortion({-0.02, 0.003, 0.0, 0.0}));
  RandomStream random(3);
  CornerCheck check;
  for (int i = 0; i < 12; ++i) {
    const double off_axis = random.uniform(0.90, 1.03);
    const Eigen::Quaterniond R =
        rotation_exp(Eigen::Vector3d(0.0, off_axis, 0.0)) *
        rotation_exp(
            Eigen::Vector3d{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-3.0, 3.0)});
    const Eigen::Vector3d place(0.8 * std::sin(off_axis), random.uniform(-0.15, 0.15),
                                0.8 * std::cos(off_axis));
    const Scene scene = one_tag(Pose(R, place), model);
    check.add(scene, Renderer(scene).sensor_light({0}, 0.004));
  }
  EXPECT_LT(std::abs(check.edges.mean()), 0.25 * kMaxMeanError_px);
  EXPECT_LT(check.edges.rms(), kMaxMeanError_px);
}

/// Mean over a pixel's area by brute force: many point samples of the pattern through the truth.
TEST(EdgePosition, PixelsAreTheMeanOverTheirArea) {
  const CameraModel model(Pinhole{520.6, 519.4, 322.4, 237.3},
                          RadtanDistortion({-0.28, 0.09, 0.0005, -0.0003}));
  const Scene scene = one_tag(Pose(rotation_exp(Eigen::Vector3d(0.5, -0.4, 0.7)), {0.25, 0.15, 1.1}), model);
  const Image<float> light = Renderer(scene).radiance({0}, 0.0);
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(7);
  const Pose T_tag_camera = scene.T_camera_map(0.0).inverse();
  const auto radiance_at = [&](double x, double y) {
    const Eigen::Vector3d ray = T_tag_camera.rotation() * model.unproject({x, y}).value();
    const Eigen::Vector3d& eye = T_tag_camera.translation();
    const Eigen::Vector3d hit = eye - eye.z() / ray.z() * ray;
    const double u = hit.x() / (0.5 * kSize_m);
    const double v = hit.y() / (0.5 * kSize_m);
    const double paper = 11.0 / 8.0;  // ten printed cells and half a cell of margin on each side
    return std::abs(u) > paper || std::abs(v) > paper ? 0.0 : pattern.brightness(u, v);
  };
  const Eigen::Vector2d centre = model.project(scene.T_camera_map(0.0).translation()).value();
  constexpr int kFine = 16;
  double sum_squared = 0.0;
  double largest = 0.0;
  int count = 0;
  for (int y = static_cast<int>(centre.y()) - 55; y <= centre.y() + 55; ++y) {
    for (int x = static_cast<int>(centre.x()) - 55; x <= centre.x() + 55; ++x) {
      double mean = 0.0;
      for (int k = 0; k < kFine * kFine; ++k) {
        mean += radiance_at(x - 0.5 + (k % kFine + 0.5) / kFine, y - 0.5 + (k / kFine + 0.5) / kFine);
      }
      const double error = light(x, y) - mean / (kFine * kFine);
      sum_squared += error * error;
      largest = std::max(largest, std::abs(error));
      ++count;
    }
  }
  EXPECT_EQ(count, 111 * 111);
  EXPECT_LT(std::sqrt(sum_squared / count), 0.004);  // 1 of 255 grey levels
  EXPECT_LT(largest, 0.06);                          // the brute force's own steps are 1/16
}

}  // namespace
}  // namespace apriltrack
