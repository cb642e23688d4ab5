// The formulas judged by another implementation of them, OpenCV's.

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "lens_models.h"

namespace apriltrack {
namespace {

std::vector<cv::Point3d> points_in_view(double max_tangent) {
  std::vector<cv::Point3d> points;
  for (int i = -6; i <= 6; ++i) {
    for (int j = -6; j <= 6; ++j) {
      const double z = 1.3 + 0.1 * i - 0.05 * j;
      points.emplace_back(max_tangent * i / 9.0 * z, max_tangent * j / 9.0 * z, z);
    }
  }
  return points;
}

void expect_same_pixels(const CameraModel& model, const std::vector<cv::Point3d>& points,
                        const std::vector<cv::Point2d>& expected) {
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = model.project({points[i].x, points[i].y, points[i].z});
    ASSERT_TRUE(pixel) << points[i];
    EXPECT_NEAR(pixel->x(), expected[i].x, 1e-9) << points[i];
    EXPECT_NEAR(pixel->y(), expected[i].y, 1e-9) << points[i];
  }
}

cv::Matx33d matrix_of(const Pinhole& p) {
  return {p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1};
}

TEST(OpenCvProjection, AgreesForEveryPinholeLens) {
  int lenses = 0;
  for (const auto& lens : test::all_lenses()) {
    const auto* radtan = std::get_if<RadtanDistortion>(&lens.model.distortion());
    if (lens.model.distortion_name() == "equidistant") continue;
    // Points up to 2/3 sqrt(2) of the valid radius.
    const auto points = points_in_view(std::min(1.0, std::tan(std::min(1.5, lens.max_angle_rad))));
    std::vector<cv::Point2d> expected;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix_of(lens.model.pinhole()),
                      radtan ? cv::Mat(radtan->coefficients(), true) : cv::Mat(), expected);
    expect_same_pixels(lens.model, points, expected);
    ++lenses;
  }
  EXPECT_EQ(lenses, 10);
}

TEST(OpenCvProjection, AgreesForEveryFisheyeLens) {
  int lenses = 0;
  for (const auto& lens : test::all_lenses()) {
    const auto* fisheye = std::get_if<EquidistantDistortion>(&lens.model.distortion());
    if (!fisheye) continue;
    const auto points = points_in_view(std::min(3.0, std::tan(std::min(1.5, lens.max_angle_rad))));
    std::vector<cv::Point2d> expected;
    cv::fisheye::projectPoints(points, expected, cv::Vec3d(), cv::Vec3d(), matrix_of(lens.model.pinhole()),
                               fisheye->coefficients());
    expect_same_pixels(lens.model, points, expected);
    ++lenses;
  }
  EXPECT_EQ(lenses, 4);
}

}  // namespace
}  // namespace apriltrack
