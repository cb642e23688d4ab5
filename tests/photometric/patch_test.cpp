#include "apriltrack/photometric/patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kPatchTagSize_m = 0.16;

CameraModel pinhole_camera() {
  return {{500.0, 480.0, 159.5, 119.5}, NoDistortion{}};
}

CameraModel distorted_camera() {
  return {{500.0, 480.0, 159.5, 119.5}, RadtanDistortion({-0.2, 0.05, 1e-3, -2e-3})};
}

double ramp(double x, double y) {
  return 20.0 + 0.5 * x - 0.25 * y;
}

Image<float> ramp_image() {
  Image<float> image(320, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) image(x, y) = static_cast<float>(ramp(x, y));
  }
  return image;
}

std::vector<double> sampled(const Image<float>& image, const CameraModel& model, const Pose& T_camera_tag,
                            const PatchGrid& grid, int* num_seen = nullptr) {
  std::vector<double> samples(grid.num_samples(), -1.0);
  const int seen =
      sample_patch(image.view(), model, camera_from_tag_plane(T_camera_tag, kPatchTagSize_m), grid, samples);
  if (num_seen != nullptr) *num_seen = seen;
  return samples;
}

/// Textbook formula in long double, over the samples that both have.
double textbook_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  long double n = 0, mean_a = 0, mean_b = 0, ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) || std::isnan(b[i])) continue;
    n += 1;
    mean_a += a[i];
    mean_b += b[i];
  }
  mean_a /= n;
  mean_b /= n;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) || std::isnan(b[i])) continue;
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return static_cast<double>(ab / std::sqrt(aa * bb));
}

std::vector<double> random_patch(RandomStream& random, std::size_t size, double seen_share) {
  std::vector<double> patch(size);
  for (double& value : patch) {
    value = random.uniform(0.0, 255.0);
    if (random.uniform() >= seen_share) value = kNaN;
  }
  return patch;
}

TEST(PatchGrid, TilesTheSquareSymmetrically) {
  const PatchGrid grid{.size = 32, .half_extent = 1.25};
  EXPECT_DOUBLE_EQ(grid.coordinate(0), -1.25 + 1.25 / 32);  // half a square from the edge
  for (int i = 0; i < 32; ++i) EXPECT_NEAR(grid.coordinate(i), -grid.coordinate(31 - i), 1e-15);
  for (int i = 1; i < 32; ++i) EXPECT_NEAR(grid.coordinate(i) - grid.coordinate(i - 1), 2.5 / 32, 1e-15);
}

TEST(PatchGrid, RefusesSizesOutOfRange) {
  EXPECT_THROW((PatchGrid{.size = 2}.check()), Error);
  EXPECT_THROW((PatchGrid{.size = 32, .half_extent = kNaN}.check()), Error);
  EXPECT_NO_THROW((PatchGrid{.size = 64, .half_extent = 1.25}.check()));
}

TEST(SampleBilinear, WeighsTheFourNeighbours) {
  Image<float> image(2, 2);
  image(0, 0) = 1.0F;
  image(1, 0) = 3.0F;
  image(0, 1) = 5.0F;
  image(1, 1) = 11.0F;
  EXPECT_DOUBLE_EQ(*sample_bilinear(image.view(), {0.25, 0.5}), 0.5 * 1.5 + 0.5 * 6.5);
  EXPECT_DOUBLE_EQ(*sample_bilinear(image.view(), {0.0, 0.0}), 1.0);
  EXPECT_DOUBLE_EQ(*sample_bilinear(image.view(), {1.0, 1.0}), 11.0);
}

TEST(SampleBilinear, SeesNothingBeyondTheOutermostCentres) {
  const Image<float> image(4, 3, 7.0F);
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(-1e-9, 1), Eigen::Vector2d(3.0 + 1e-9, 1), Eigen::Vector2d(1, -1e-9),
        Eigen::Vector2d(1, 2.0 + 1e-9), Eigen::Vector2d(kNaN, 1), Eigen::Vector2d(1e300, 1)}) {
    EXPECT_FALSE(sample_bilinear(image.view(), pixel)) << pixel.transpose();
  }
}

TEST(SamplePatch, ReadsALinearRampExactly) {
  const Image<float> image = ramp_image();
  const PatchGrid grid{.size = 9, .half_extent = 1.2};
  const Pose T_camera_tag(rotation_exp({0.4, -0.5, 0.3}), {0.03, -0.02, 0.6});
  int num_checked = 0;
  for (const CameraModel& model : {pinhole_camera(), distorted_camera()}) {
    const std::vector<double> samples = sampled(image, model, T_camera_tag, grid);
    for (int row = 0; row < 9; ++row) {
      for (int column = 0; column < 9; ++column) {
        const double u = 1.2 * (-1.0 + (2 * column + 1) / 9.0), v = 1.2 * (-1.0 + (2 * row + 1) / 9.0);
        const auto pixel = model.project(T_camera_tag * (0.5 * kPatchTagSize_m * Eigen::Vector3d(u, v, 0.0)));
        ASSERT_TRUE(pixel);
        // Pixels are floats of about 100: 1e-5 is their rounding.
        EXPECT_NEAR(samples[static_cast<std::size_t>(row * 9 + column)], ramp(pixel->x(), pixel->y()), 2e-5);
        ++num_checked;
      }
    }
  }
  EXPECT_EQ(num_checked, 2 * 81);
}

TEST(SamplePatch, SeesTheHalfThatIsInTheImage) {
  const Image<float> image(320, 240, 1.0F);
  const PatchGrid grid{.size = 16};
  // Centred on the middle of the leftmost pixels, facing the camera.
  const Pose T_camera_tag(Eigen::Quaterniond::Identity(), {-159.5 / 500.0 * 0.8, 0.0, 0.8});
  int num_seen = 0;
  const std::vector<double> samples = sampled(image, pinhole_camera(), T_camera_tag, grid, &num_seen);
  EXPECT_EQ(num_seen, 16 * 8);
  for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_EQ(std::isnan(samples[i]), i % 16 < 8) << i;
}

TEST(SamplePatch, SeesNothingOfATagTurnedAwayOrBehind) {
  const Image<float> image(320, 240, 1.0F);
  const PatchGrid grid{.size = 8};
  const Pose facing(Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.8});
  const Pose turned_away(rotation_exp({0.0, std::acos(-1.0), 0.0}), {0.0, 0.0, 0.8});
  const Pose behind(Eigen::Quaterniond::Identity(), {0.0, 0.0, -0.8});
  int num_seen = 0;
  sampled(image, pinhole_camera(), facing, grid, &num_seen);
  EXPECT_EQ(num_seen, 64);
  for (const Pose& T_camera_tag : {turned_away, behind}) {
    const std::vector<double> samples = sampled(image, pinhole_camera(), T_camera_tag, grid, &num_seen);
    EXPECT_EQ(num_seen, 0);
    for (const double value : samples) EXPECT_TRUE(std::isnan(value));
  }
}

TEST(SamplePatch, SeesOnlyWhatIsBeforeTheCamera) {
  // A tag that passes beside the camera: its right half is in front, its left half behind.
  const Pose T_camera_tag(rotation_exp({0.0, -1.5, 0.0}), {0.02, 0.0, 0.001});
  const PatchGrid grid{.size = 16};
  const CameraModel wide({20.0, 20.0, 1999.5, 119.5}, NoDistortion{});
  const Image<float> image(4000, 240, 1.0F);
  const std::vector<double> samples = sampled(image, wide, T_camera_tag, grid);
  int num_before = 0, num_behind = 0;
  for (int row = 0; row < 16; ++row) {
    for (int column = 0; column < 16; ++column) {
      const Eigen::Vector3d point =
          T_camera_tag *
          (0.5 * kPatchTagSize_m * Eigen::Vector3d(grid.coordinate(column), grid.coordinate(row), 0));
      if (point.z() > 0.0) {
        ++num_before;
      } else {
        ++num_behind;
        EXPECT_TRUE(std::isnan(samples[static_cast<std::size_t>(row * 16 + column)]));
      }
    }
  }
  EXPECT_GT(num_before, 50);
  EXPECT_GT(num_behind, 50);
}

TEST(Correlate, AgreesWithTheTextbook) {
  RandomStream random(20);
  for (int trial = 0; trial < 50; ++trial) {
    const std::vector<double> a = random_patch(random, 100, 0.8);
    std::vector<double> b = random_patch(random, 100, 0.8);
    for (std::size_t i = 0; i < b.size(); ++i) b[i] += trial * 0.05 * (std::isnan(a[i]) ? 0.0 : a[i]);
    int num_common = 0;
    for (std::size_t i = 0; i < b.size(); ++i) num_common += !std::isnan(a[i]) && !std::isnan(b[i]) ? 1 : 0;
    const PatchMatch match = correlate(a, b);
    EXPECT_EQ(match.num_samples, num_common);
    EXPECT_NEAR(match.correlation, textbook_correlation(a, b), 1e-12);
  }
}

TEST(Correlate, KeepsItsDigitsOnABrightPatch) {
  RandomStream random(21);
  std::vector<double> a = random_patch(random, 400, 1.0), b = random_patch(random, 400, 1.0);
  const double expected = textbook_correlation(a, b);
  for (double& value : a) value += 1e6;
  EXPECT_NEAR(correlate(a, b).correlation, expected, 1e-9);
}

TEST(Correlate, IgnoresAnAffineChangeOfLight) {
  RandomStream random(22);
  const std::vector<double> a = random_patch(random, 64, 0.9), b = random_patch(random, 64, 0.9);
  std::vector<double> brighter = a, negative = a;
  for (std::size_t i = 0; i < a.size(); ++i) {
    brighter[i] = 0.3 * a[i] + 40.0;
    negative[i] = 255.0 - a[i];
  }
  EXPECT_NEAR(correlate(brighter, b).correlation, correlate(a, b).correlation, 1e-13);
  EXPECT_NEAR(correlate(a, brighter).correlation, 1.0, 1e-13);
  EXPECT_NEAR(correlate(a, negative).correlation, -1.0, 1e-13);
}

TEST(Correlate, SaysNothingOfAConstantPatch) {
  RandomStream random(23);
  const std::vector<double> picture = random_patch(random, 64, 1.0);
  const std::vector<double> constant(64, 0.1 + 0.2);
  EXPECT_EQ(correlate(picture, constant).correlation, 0.0);
  EXPECT_EQ(correlate(constant, picture).correlation, 0.0);
}

TEST(Correlate, SaysNothingOfTooFewSamples) {
  RandomStream random(24);
  std::vector<double> patch = random_patch(random, 64, 1.0);
  std::vector<double> few = patch;
  for (std::size_t i = 7; i < few.size(); ++i) few[i] = kNaN;
  EXPECT_EQ(correlate(patch, few).num_samples, 7);
  EXPECT_EQ(correlate(patch, few).correlation, 0.0);
  few[7] = patch[7];
  EXPECT_NEAR(correlate(patch, few).correlation, 1.0, 1e-12);
}

}  // namespace
}  // namespace apriltrack
