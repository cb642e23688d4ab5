#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "apriltrack/base/random.h"
#include "lens_scene.h"

namespace apriltrack {
namespace {

using namespace test;

constexpr double kTagEdge_px = 28.0;      // of the black border's outer edge, where it faces the camera
constexpr double kCells = 8.0;            // along that edge
constexpr double kPaperCells = 11.0;      // ten are printed, with half a cell of margin on either side
constexpr double kMaxTagError = 2.5e-3;   // of full light, where the edges of cells meet in a pixel
constexpr double kMaxTiltedError = 8e-3;  // as pixels are then made of upright parts

struct TagPlace {
  double focal_px = 500.0;
  Pose T_camera_tag;
};

Scene tag_scene(const TagPlace& place, double sigma_px) {
  Scene scene = lens_scene(sigma_px, {});
  scene.camera.model = CameraModel(
      Pinhole{place.focal_px, place.focal_px, 0.5 * kLensWidth, 0.5 * kLensHeight}, NoDistortion{});
  MapTag tag;
  tag.key = {"tag36h11", 7};
  tag.size_m = kTagEdge_px / place.focal_px;  // 1 m away
  scene.map.tags = {tag};
  Body body{.name = "tag", .T_world_body = Motion::fixed(place.T_camera_tag), .panels = {}};
  add_tags(body, scene.map, {.margin_cells = 0.5, .ink = 0.0, .paper = 1.0});
  scene.bodies = {body};
  return scene;
}

/// Light of the print, u and v in cells from the tag's middle.
double printed_light(double u, double v) {
  static const TagPattern pattern = TagFamily::get("tag36h11").pattern(7);
  const double paper = 0.5 * kPaperCells;
  return std::abs(u) > paper || std::abs(v) > paper ? 0.0
                                                    : pattern.brightness(2 * u / kCells, 2 * v / kCells);
}

/// Where a tag stands upright in the picture: centre and edges, px.
using Frame4 = Eigen::Vector4d;

/// In closed form: a print's cells are differences of steps.
class UprightTag {
 public:
  explicit UprightTag(double sigma_px) : step_(sigma_px) {}

  Image<double> picture(const Frame4& frame) const {
    const auto across = shares(frame[0], frame[2] / kCells, kLensWidth);
    const auto down = shares(frame[1], frame[3] / kCells, kLensHeight);
    Image<double> light(kLensWidth, kLensHeight, 0.0);
    for (int y = 0; y < kLensHeight; ++y) {
      for (int x = 0; x < kLensWidth; ++x) {
        for (int j = 0; j < kHalves; ++j) {
          const double share = down[j][y];
          if (std::abs(share) < 1e-9) continue;
          for (int i = 0; i < kHalves; ++i)
            light(x, y) += across[i][x] * share * printed_light(0.5 * i - 5.25, 0.5 * j - 5.25);
        }
      }
    }
    return light;
  }

 private:
  static constexpr int kHalves = 22;  // of cells, as the paper ends in the middle of one

  /// Of every half cell, what pixel p shows.
  std::vector<std::vector<double>> shares(double centre, double cell_px, int count) const {
    std::vector<std::vector<double>> result(kHalves, std::vector<double>(count));
    for (int i = 0; i < kHalves; ++i) {
      const double low = centre + (0.5 * i - 5.5) * cell_px;
      for (int p = 0; p < count; ++p)
        result[i][p] = step_.upright(p - low) - step_.upright(p - low - 0.5 * cell_px);
    }
    return result;
  }

  BlurredStep step_;
};

TEST(LensOnATag, KeepsThePlaceAndTheSizeOfAnUprightOne) {
  RandomStream random(1);
  for (const double sigma_px : {0.3, 0.5, 1.2}) {
    const UprightTag tag(sigma_px);
    for (int i = 0; i < 4; ++i) {
      TagPlace place;
      const Eigen::Vector2d place_px{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)};
      place.T_camera_tag = {Eigen::Quaterniond::Identity(),
                            {place_px.x() / place.focal_px, place_px.y() / place.focal_px, 1.0}};
      const Image<float> light = light_behind(tag_scene(place, sigma_px));
      const Frame4 truth(0.5 * kLensWidth + place_px.x(), 0.5 * kLensHeight + place_px.y(), kTagEdge_px,
                         kTagEdge_px);
      const Image<double> exact = tag.picture(truth);
      std::vector<Image<double>> more, less;
      constexpr double kStep_px = 0.01;
      for (int k = 0; k < 4; ++k) {
        more.push_back(tag.picture(truth + kStep_px * Frame4::Unit(k)));
        less.push_back(tag.picture(truth - kStep_px * Frame4::Unit(k)));
      }
      Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
      Frame4 pull = Frame4::Zero();
      for (int y = 2; y < kLensHeight - 2; ++y) {
        for (int x = 2; x < kLensWidth - 2; ++x) {
          Frame4 slope;
          for (int k = 0; k < 4; ++k) slope[k] = (more[k](x, y) - less[k](x, y)) / (2 * kStep_px);
          normal += slope * slope.transpose();
          pull += slope * (light(x, y) - exact(x, y));
          EXPECT_NEAR(light(x, y), exact(x, y), kMaxTagError) << sigma_px << ' ' << x << ' ' << y;
        }
      }
      const Frame4 shift = normal.inverse() * pull;
      EXPECT_LT(shift.cwiseAbs().maxCoeff(), kMaxLensShift_px) << sigma_px << ": " << shift.transpose();
    }
  }
}

/// By brute force: points of the print, summed with what a pixel shows of a point.
class TiltedTag {
 public:
  /// size: of the print, relative to the true one.
  TiltedTag(const TagPlace& place, double size) {
    const Pose T_tag_camera = place.T_camera_tag.inverse();
    const Eigen::Vector3d& eye = T_tag_camera.translation();
    const double cell_m = size * kTagEdge_px / place.focal_px / kCells;
    for (int y = 0; y < points_.height(); ++y) {
      for (int x = 0; x < points_.width(); ++x) {
        const Eigen::Vector3d ray =
            T_tag_camera.rotation() * Eigen::Vector3d(off_centre(x, kWidth) / place.focal_px,
                                                      off_centre(y, kHeight) / place.focal_px, 1.0);
        const Eigen::Vector3d hit = eye - eye.z() / ray.z() * ray;
        points_(x, y) = printed_light(hit.x() / cell_m, hit.y() / cell_m);
      }
    }
  }

  Image<double> picture(double sigma_px) const {
    Image<double> rows(kWidth, points_.height(), 0.0), light(kWidth, kHeight, 0.0);
    const auto reach = static_cast<int>(std::ceil((0.5 + 5 * sigma_px) * kFine));
    const BlurredStep step(sigma_px);
    std::vector<double> weights;
    for (int k = -reach; k < reach; ++k) weights.push_back(step.slope((k + 0.5) / kFine) / kFine);
    const auto middle = [&](int pixel) { return pixel * kFine + kFine / 2; };
    for (int y = 0; y < points_.height(); ++y) {
      for (int x = kRim; x < kWidth - kRim; ++x) {
        for (int k = -reach; k < reach; ++k) rows(x, y) += weights[k + reach] * points_(middle(x) + k, y);
      }
    }
    for (int y = kRim; y < kHeight - kRim; ++y) {
      for (int x = kRim; x < kWidth - kRim; ++x) {
        for (int k = -reach; k < reach; ++k) light(x, y) += weights[k + reach] * rows(x, middle(y) + k);
      }
    }
    return light;
  }

  static constexpr int kWidth = 48, kHeight = 48, kRim = 7;

 private:
  static constexpr int kFine = 24;  // points per pixel, each way

  static double off_centre(int point, int pixels) { return (point + 0.5) / kFine - 0.5 - 0.5 * pixels; }

  Image<double> points_{kWidth * kFine, kHeight* kFine};
};

TEST(LensOnATag, KeepsTheSizeOfATiltedOne) {
  RandomStream random(2);
  int count = 0;
  for (int i = 0; i < 2; ++i) {
    TagPlace place;
    const Eigen::Quaterniond tilt = rotation_exp(Eigen::Vector3d(0, M_PI / 4, 0));
    place.T_camera_tag = {rotation_exp(Eigen::Vector3d(0, 0, random.uniform(0.1, 0.6))) * tilt,
                          {random.uniform(-1, 1) * 1e-3, random.uniform(-1, 1) * 1e-3, 1.0}};
    const TiltedTag exact(place, 1.0), larger(place, 1.01), smaller(place, 0.99);
    for (const double sigma_px : {0.35, 0.5, 1.0}) {
      const Image<float> light = light_behind(tag_scene(place, sigma_px));
      const Image<double> truth = exact.picture(sigma_px), more = larger.picture(sigma_px),
                          less = smaller.picture(sigma_px);
      double normal = 0.0, pull = 0.0;
      for (int y = TiltedTag::kRim; y < TiltedTag::kHeight - TiltedTag::kRim; ++y) {
        for (int x = TiltedTag::kRim; x < TiltedTag::kWidth - TiltedTag::kRim; ++x) {
          const double slope = (more(x, y) - less(x, y)) / (0.02 * kTagEdge_px);
          const double error =
              light(x + (kLensWidth - TiltedTag::kWidth) / 2, y + (kLensHeight - TiltedTag::kHeight) / 2) -
              truth(x, y);
          EXPECT_NEAR(error, 0.0, kMaxTiltedError) << x << ' ' << y;
          normal += slope * slope;
          pull += slope * error;
        }
      }
      EXPECT_LT(std::abs(pull / normal), kMaxLensShift_px) << sigma_px;
      ++count;
    }
  }
  EXPECT_EQ(count, 6);
}

}  // namespace
}  // namespace apriltrack
