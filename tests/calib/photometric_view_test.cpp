#include "pictures/photometric_view.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "apriltrack/tags/tag_family.h"
#include "support/pose_matchers.h"

// One picture of one tag, painted point by point by code of these tests alone.

namespace apriltrack {
namespace {

constexpr double kSize_m = 0.16;
constexpr double kPsf_px = 0.5;

Camera plain_camera() {
  return {.name = "cam0",
          .model = CameraModel({520.0, 520.0, 80.0, 60.0}, NoDistortion{}),
          .width = 150,
          .height = 116};
}

PrintedTag printed_tag() {
  return {TagFamily::get("tag36h11").pattern(7), 0.5 * kSize_m};
}

Pose T_camera_tag(double distance_m, double tilt_rad) {
  const Eigen::Quaterniond tilted(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d(0.6, 0.8, 0.0)));
  return {tilted * Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ())),
          {0.013, -0.021, distance_m}};
}

/// Of a number that is spread evenly over a pixel, and by a Gaussian about that: where its share below is
/// `share`, by bisection.
double quantile_px(double share) {
  const auto share_below = [](double place_px) {
    constexpr int kSlices = 64;
    double sum = 0.0;
    for (int i = 0; i < kSlices; ++i)
      sum += std::erfc(-(place_px + 0.5 - (i + 0.5) / kSlices) / (kPsf_px * std::numbers::sqrt2));
    return 0.5 * sum / kSlices;
  };
  double low = -5.0, high = 5.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (share_below(middle) < share ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Light of a place of the image: the mean over points that are spread as a pixel and the lens spread light.
class Painter {
 public:
  using Lamp = std::function<double(double u, double v)>;

  Painter(const Camera& camera, const PrintedTag& tag, const Pose& pose)
      : camera_(camera), tag_(tag), pose_(pose) {
    constexpr int kSide = 24;
    for (int i = 0; i < kSide; ++i) offsets_px_.push_back(quantile_px((i + 0.5) / kSide));
  }

  GrayImage painted(const Lamp& lamp) const {
    GrayImage image(camera_.width, camera_.height);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) image(x, y) = code(mean_light({x, y}, lamp));
    }
    return image;
  }

 private:
  double mean_light(const Eigen::Vector2d& pixel, const Lamp& lamp) const {
    double sum = 0.0;
    for (const double x : offsets_px_) {
      for (const double y : offsets_px_) sum += light(pixel + Eigen::Vector2d(x, y), lamp);
    }
    return sum / static_cast<double>(offsets_px_.size() * offsets_px_.size());
  }

  double light(const Eigen::Vector2d& pixel, const Lamp& lamp) const {
    const Eigen::Vector3d ray((pixel.x() - 80.0) / 520.0, (pixel.y() - 60.0) / 520.0, 1.0);
    const Eigen::Matrix3d R = pose_.rotation_matrix();
    const Eigen::Vector3d t = pose_.translation();
    const Eigen::Vector3d point = R.transpose() * (R.col(2).dot(t) / R.col(2).dot(ray) * ray - t);
    const double u = point.x() / tag_.half_size_m, v = point.y() / tag_.half_size_m;
    if (std::max(std::abs(u), std::abs(v)) > tag_.pattern.half_extent()) return 0.35;
    return lamp(u, v) * (0.04 + 0.7 * tag_.pattern.brightness(u, v));
  }

  std::uint8_t code(double light) const {
    const ResponseCurve& response = camera_.response;
    int best = 0;
    for (int c = 1; c < 256; ++c) {
      if (std::abs(response.linear_light()[static_cast<std::size_t>(c)] - light) <
          std::abs(response.linear_light()[static_cast<std::size_t>(best)] - light))
        best = c;
    }
    return static_cast<std::uint8_t>(best);
  }

  const Camera& camera_;
  const PrintedTag& tag_;
  Pose pose_;
  std::vector<double> offsets_px_;
};

struct Fitted {
  Pose pose;
  double psf_sigma_px = 0.6;
};

/// Gauss-Newton from a start that is a fifth of a pixel off.
Fitted fitted(const Camera& camera, const PrintedTag& tag, const GrayImage& image, const Pose& truth,
              bool learns_light) {
  Fitted fit{truth * Pose::exp((Vector6d() << 3e-4, -2e-4, 2e-3, 4e-3, -5e-3, 1e-3).finished())};
  PhotometricView view;
  EXPECT_TRUE(read_pixels({{"tag36h11", 7}, 0, 0, image}, camera, tag, fit.pose, fit.psf_sigma_px, view));
  TagLight light(tag.pattern.half_extent(), tag.pattern.cells().width());
  for (int step = 0; step < 25; ++step) {
    TagLight::Sums sums(light);
    const auto equations = view_equations(view, camera.model, tag, fit.pose, fit.psf_sigma_px, light, sums);
    if (!equations) {
      ADD_FAILURE() << "the tag is not seen";
      return fit;
    }
    const Vector7d move = -equations->H.ldlt().solve(equations->g);
    fit.pose = Pose::exp(Vector6d(move.head<6>())) * fit.pose;
    fit.psf_sigma_px += move[6];
    if (learns_light) light.update(sums);
  }
  return fit;
}

double range_error(const Pose& found, const Pose& truth) {
  return found.translation().norm() / truth.translation().norm() - 1.0;
}

/// In pixels of the tag's edge, seen head-on.
double range_error_px(const Pose& found, const Pose& truth) {
  return range_error(found, truth) * 520.0 * kSize_m / truth.translation().norm();
}

double even(double, double) {
  return 1.0;
}

/// A lamp beside the tag, and a shadow on it.
double uneven(double u, double v) {
  return 1.0 + 0.25 * std::exp(-3.0 * ((u - 1.1) * (u - 1.1) + (v + 0.6) * (v + 0.6))) -
         0.2 * std::exp(-9.0 * ((u + 0.9) * (u + 0.9) + (v - 0.9) * (v - 0.9)));
}

TEST(PhotometricView, FindsAPaintedTagAndItsBlur) {
  const Camera camera = plain_camera();
  const PrintedTag tag = printed_tag();
  for (const double distance_m : {1.2, 2.8}) {
    for (const double tilt_rad : {0.1, 0.8}) {
      const Pose truth = T_camera_tag(distance_m, tilt_rad);
      const Fitted fit = fitted(camera, tag, Painter(camera, tag, truth).painted(even), truth, false);
      EXPECT_NEAR(range_error_px(fit.pose, truth), 0.0, 0.014) << distance_m << " m, " << tilt_rad << " rad";
      EXPECT_NEAR(fit.psf_sigma_px, kPsf_px, 0.03);
      EXPECT_LT(rotation_angle_rad(fit.pose.rotation(), truth.rotation()), tilt_rad < 0.5 ? 5e-3 : 1e-3);
    }
  }
}

TEST(PhotometricView, LearnsTheLightThatBendsItsEdges) {
  const Camera camera = plain_camera();
  const PrintedTag tag = printed_tag();
  double with_light_rad = 0.0, without_rad = 0.0;
  for (const double distance_m : {1.2, 1.9, 2.8}) {
    for (const double tilt_rad : {0.6, 0.9}) {
      const Pose truth = T_camera_tag(distance_m, tilt_rad);
      const GrayImage image = Painter(camera, tag, truth).painted(uneven);
      const auto angle_off = [&](bool learns_light) {
        return rotation_angle_rad(fitted(camera, tag, image, truth, learns_light).pose.rotation(),
                                  truth.rotation());
      };
      EXPECT_LT(angle_off(true), 1.2e-3) << distance_m << " m, " << tilt_rad << " rad";
      with_light_rad += angle_off(true);
      without_rad += angle_off(false);
    }
  }
  EXPECT_GT(without_rad, 1.5 * with_light_rad);
}

TEST(PhotometricView, TakesNothingForTheTagThatIsAnother) {
  const Camera camera = plain_camera();
  const PrintedTag tag = printed_tag();
  const PrintedTag other{TagFamily::get("tag36h11").pattern(8), tag.half_size_m};
  const Pose truth = T_camera_tag(1.5, 0.3);
  const GrayImage image = Painter(camera, tag, truth).painted(even);
  PhotometricView view;
  ASSERT_TRUE(read_pixels({{"tag36h11", 8}, 0, 0, image}, camera, other, truth, kPsf_px, view));
  TagLight light(other.pattern.half_extent(), other.pattern.cells().width());
  TagLight::Sums sums(light);
  EXPECT_FALSE(view_equations(view, camera.model, other, truth, kPsf_px, light, sums).has_value());
}

TEST(PhotometricView, LeavesOutWhatIsSaturatedAndWhatIsAboutIt) {
  const Camera camera = plain_camera();
  const PrintedTag tag = printed_tag();
  const Pose truth = T_camera_tag(1.5, 0.3);
  GrayImage image = Painter(camera, tag, truth).painted(even);
  PhotometricView before, after;
  ASSERT_TRUE(read_pixels({{"tag36h11", 7}, 0, 0, image}, camera, tag, truth, kPsf_px, before));
  image(80, 60) = 255;
  ASSERT_TRUE(read_pixels({{"tag36h11", 7}, 0, 0, image}, camera, tag, truth, kPsf_px, after));
  EXPECT_EQ(before.light.size() - after.light.size(), 25U);
}

}  // namespace
}  // namespace apriltrack
