#include "patch_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/photometric/joint_likelihood.h"
#include "instruction_sets.h"
#include "patch_columns.h"
#include "patch_placement.h"
#include "tag_film.h"
#include "tag_prediction.h"

// Every kernel on every instruction set of this machine, against sample_patch, TagPrediction::predict and
// correlate, which are in double precision.

namespace apriltrack {
namespace {

constexpr double kNoLight = std::numeric_limits<double>::quiet_NaN();
constexpr int kPatchImageWidth = 320, kPatchImageHeight = 240;

/// Where a pixel is within 8 of them can be read from its light, whose steps are fine then.
constexpr int kRampLength_px = 8;
Image<float> ramp(bool is_of_rows) {
  Image<float> image(kPatchImageWidth, kPatchImageHeight);
  for (int y = 0; y < kPatchImageHeight; ++y)
    for (int x = 0; x < kPatchImageWidth; ++x)
      image(x, y) = static_cast<float>((is_of_rows ? y : x) % kRampLength_px);
  return image;
}
/// Off the steps between one ramp and the next.
bool is_on_ramp(double pixel) {
  const double place = std::fmod(pixel, kRampLength_px);
  return place > 0.01 && place < kRampLength_px - 1.01;
}

/// Smooth enough for a place's error of 1e-3 px to be one of less in c, rough enough to be a picture.
Image<float> picture(std::uint64_t seed) {
  RandomStream random(seed);
  Image<float> image(kPatchImageWidth, kPatchImageHeight);
  const double fx = random.uniform(0.1, 0.4), fy = random.uniform(0.1, 0.4);
  for (int y = 0; y < kPatchImageHeight; ++y) {
    for (int x = 0; x < kPatchImageWidth; ++x) {
      image(x, y) = static_cast<float>(0.5 + 0.25 * std::sin(fx * x + 0.3 * fy * y) +
                                       0.2 * std::cos(fy * y - 0.1 * x) + 0.05 * random.uniform());
    }
  }
  return image;
}

const std::vector<CameraModel>& lenses() {
  static const std::vector<CameraModel> models = {
      {{200.0, 205.0, 150.0, 130.0}, NoDistortion{}},
      {{200.0, 205.0, 150.0, 130.0}, RadtanDistortion({-0.3, 0.1, 2e-3, -1e-3})},
      {{200.0, 205.0, 150.0, 130.0}, RadtanDistortion({0.2, 0.1, 1e-3, 1e-3, 0.05, 0.4, 0.2, 0.02})},
      {{110.0, 112.0, 150.0, 130.0}, EquidistantDistortion({0.02, -0.01, 3e-3, -1e-3})},
      {{70.0, 70.0, 159.5, 119.5}, EquidistantDistortion({0.0, 0.0, 0.0, 0.0})},  // sees behind itself
  };
  return models;
}

/// Before the camera, beside it, behind it, on edge; of an edge of 16 cm.
Eigen::Matrix3d random_view(RandomStream& random, double spread) {
  const Eigen::Vector3d place{random.uniform(-spread, spread), random.uniform(-spread, spread),
                              random.uniform(-0.2, 1.0)};
  const Eigen::Vector3d turn{random.normal(), random.normal(), 2.0 * random.normal()};
  return camera_from_tag_plane({rotation_exp(turn), place}, 0.16);
}

/// Standard deviation of what is seen.
double contrast_of(const std::vector<double>& seen) {
  double count = 0.0, sum = 0.0, squares = 0.0;
  for (const double value : seen) {
    if (std::isnan(value)) continue;
    count += 1.0;
    sum += value;
    squares += value * value;
  }
  return count > 0.0 ? std::sqrt(std::max(squares / count - sum * sum / (count * count), 0.0)) : 0.0;
}
/// Ten of the kernels' steps of light, of images whose light is in [0, 1]: with less, c is off by 1e-3.
constexpr double kLeastContrast = 1.5e-4;

class PatchKernels : public ::testing::TestWithParam<std::int64_t> {
 protected:
  const test::InstructionSet instruction_set_{GetParam()};
  const std::array<Image<float>, 2> pictures_ = {picture(1), picture(2)};
};

INSTANTIATE_TEST_SUITE_P(InstructionSets, PatchKernels, ::testing::ValuesIn(test::instruction_sets()),
                         test::instruction_set_name);

PatchSums sums_over(const Image<float>& image, const CameraModel& model, const Eigen::Matrix3d& M,
                    const PatchGrid& grid, const PatchColumns& columns, double max_light) {
  const PlacedPatch placed = place_patch(image.view(), model, M, grid);
  RowPairs rows;
  rows.start(image.view(), max_light);
  rows.make(placed.box);
  return sum_patch(rows.rows(), lens_factors(model), placed.placement, columns.samples(0, columns.size()),
                   {columns.light.data(), nullptr, 0.0, columns.sum_squares});
}

TEST_P(PatchKernels, CorrelateAsTheDefinitionDoes) {
  RandomStream random(31);
  int num_whole = 0, num_cut = 0, num_saturated = 0, num_unknown = 0, num_gone = 0;
  int num_other_counts = 0, num_compared = 0;
  double worst = 0.0;
  for (std::size_t lens = 0; lens < lenses().size(); ++lens) {
    for (int trial = 0; trial < 900; ++trial) {
      const PatchGrid grid{.size = trial % 3 == 0 ? 32 : 5 + trial % 29,
                           .half_extent = 1.0 + 0.2 * (trial % 2)};
      const Image<float>& image = trial % 2 == 0 ? pictures_[0] : pictures_[1];
      const double max_light = trial % 5 == 0 ? 0.9 : std::numeric_limits<double>::infinity();
      const Eigen::Matrix3d M = random_view(random, trial % 4 == 0 ? 0.1 : 1.0);
      if (!(M.determinant() > 0.0)) continue;  // place_patch is not asked
      std::vector<double> reference(grid.num_samples()), seen(grid.num_samples());
      for (double& value : reference) value = random.uniform(0.0, 200.0);
      if (trial % 7 == 0)
        for (std::size_t i = 0; i < reference.size(); i += 1 + i % 5) reference[i] = kNoLight;
      const int num_seen = sample_patch(image.view(), lenses()[lens], M, grid, seen, max_light);
      // Something of the patch is in the template, so that c is not only noise.
      for (std::size_t i = 0; i < seen.size(); ++i)
        if (!std::isnan(seen[i])) reference[i] += 300.0 * seen[i];
      const PatchMatch expected = correlate(seen, reference);
      PatchColumns columns;
      fill_columns(grid, all_cells(grid), reference, &columns);
      const PatchMatch found = match_of(sums_over(image, lenses()[lens], M, grid, columns, max_light));
      // Two samples in a thousand patches lie on the very edge of the image, or beside a light of just the
      // limit.
      EXPECT_NEAR(found.num_samples, expected.num_samples, max_light < 1.0 ? 3 : 1);
      if (found.num_samples != expected.num_samples) {
        ++num_other_counts;
        continue;
      }
      EXPECT_NEAR(found.correlation, expected.correlation, 1e-3) << trial << " " << lens;
      worst = std::max(worst, std::abs(found.correlation - expected.correlation));
      ++num_compared;
      num_whole += num_seen == static_cast<int>(grid.num_samples()) ? 1 : 0;
      num_cut += num_seen > 0 && num_seen < static_cast<int>(grid.num_samples()) ? 1 : 0;
      num_gone += num_seen == 0 ? 1 : 0;
      num_saturated += max_light < 1.0 && num_seen > 0 ? 1 : 0;
      num_unknown += trial % 7 == 0 && expected.num_samples > 8 ? 1 : 0;
    }
  }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 2e-4);
  EXPECT_GT(num_compared, 1800);
  EXPECT_LT(num_other_counts, num_compared / 200);
  EXPECT_GT(num_whole, 150);
  EXPECT_GT(num_cut, 150);
  EXPECT_GT(num_gone, 150);
  EXPECT_GT(num_saturated, 60);
  EXPECT_GT(num_unknown, 60);
}

/// A sample's place is read from the light of a ramp: it is alone in its block, the others being nowhere.
TEST_P(PatchKernels, ProjectThroughEveryLensToAThousandthOfAPixel) {
  const Image<float> columns_image = ramp(false), rows_image = ramp(true);
  RandomStream random(32);
  for (std::size_t lens = 0; lens < lenses().size(); ++lens) {
    const CameraModel& model = lenses()[lens];
    int num_seen = 0, num_wide = 0;
    double worst_px = 0.0;
    for (int trial = 0; trial < 4000; ++trial) {
      // One place in the tag's plane, in a block of places that are nowhere.
      const Eigen::Matrix3d M = random_view(random, 0.8);
      PatchColumns one;
      one.u.assign(kPatchBlock, std::numeric_limits<float>::quiet_NaN());
      one.v = one.u;
      one.light.assign(kPatchBlock, 1.0F);
      one.num_samples = 1;
      const std::size_t lane = static_cast<std::size_t>(trial) % kPatchBlock;
      one.u[lane] = static_cast<float>(random.uniform(-1.0, 1.0));
      one.v[lane] = static_cast<float>(random.uniform(-1.0, 1.0));
      const Eigen::Vector3d point =
          M * Eigen::Vector3d(static_cast<double>(one.u[lane]), static_cast<double>(one.v[lane]), 1.0);
      const auto pixel = model.project(point);
      const bool is_in_image = pixel && pixel->x() > 0.01 && pixel->y() > 0.01 &&
                               pixel->x() < kPatchImageWidth - 1.01 && pixel->y() < kPatchImageHeight - 1.01;
      if (!is_in_image || !is_on_ramp(pixel->x()) || !is_on_ramp(pixel->y())) continue;
      const Eigen::Vector2d on_ramps(std::fmod(pixel->x(), kRampLength_px),
                                     std::fmod(pixel->y(), kRampLength_px));
      const PatchGrid grid;
      const PlacedPatch placed = place_patch(columns_image.view(), model, M, grid);
      const auto light_of = [&](const Image<float>& image) {
        const PatchSums sums = sums_over(image, model, M, grid, one, std::numeric_limits<double>::infinity());
        EXPECT_EQ(sums.count, 1.0) << lens << " " << trial;
        return sums.a + static_cast<double>(image(placed.placement.base_x, placed.placement.base_y));
      };
      const Eigen::Vector2d found(light_of(columns_image), light_of(rows_image));
      worst_px = std::max(worst_px, (found - on_ramps).norm());
      ++num_seen;
      num_wide += point.z() < 0.5 * point.head<2>().norm() ? 1 : 0;  // beyond 63 degrees
    }
    EXPECT_LT(worst_px, 1e-3) << lens;
    EXPECT_GT(num_seen, 300) << lens;
    if (lens >= 3) {
      EXPECT_GT(num_wide, 100) << lens;
    }
  }
}

TEST_P(PatchKernels, WholePatchesThroughPatternsAgreeWithTheDefinition) {
  const PatchGrid grid;
  RandomStream random(33);
  for (std::size_t lens = 0; lens < lenses().size(); ++lens) {
    const CameraModel& model = lenses()[lens];
    Motion motion = Motion::fixed({rotation_exp({0.4, 0.2, 0.1}), Eigen::Vector3d(0.02, 0.0, 0.4)});
    motion.position_m[0].rate_per_s = 1.5;
    const test::TagFilm film(model, motion);
    JointLikelihood likelihood(film.camera, film.map, TrackMode::kJoint);
    PhotometricWorld world = film.world();
    int num_agreeing = 0;
    for (int trial = 0; trial < 60; ++trial) {
      Vector12d step;
      for (Eigen::Index k = 0; k < 12; ++k)
        step[k] = (k < 6 ? 0.1 : 0.5) * (trial % 6) / 5.0 * random.normal();
      const MotionState state = moved(film.truth, step);
      JointScores scores;
      likelihood.evaluate(film.frame, std::vector{state}, parallel_for(1), &scores);
      ViewPath path(state, film.frame.exposure_s, world.mode);
      const TagPrediction prediction(world, world.tags[0], path, 0);
      if (!prediction.is_visible()) continue;
      const Eigen::Matrix3d M = camera_from_tag_plane(state.pose, test::TagFilm::kSize_m);
      std::vector<double> seen(grid.num_samples()), expected(grid.num_samples(), kNoLight);
      sample_patch(film.frame.light[0].view(), model, M, grid, seen);
      for (int i = 0; i < grid.size * grid.size; ++i) {
        const Eigen::Vector3d point =
            M * Eigen::Vector3d(grid.coordinate(i % grid.size), grid.coordinate(i / grid.size), 1.0);
        if (!(point.z() > 0.0)) continue;
        const PixelPrediction at = prediction.predict((point.head<2>() / point.z()).cast<float>());
        if (at.presence >= 0.5F)
          expected[static_cast<std::size_t>(i)] =
              static_cast<double>(at.light) + 1.0 - static_cast<double>(at.presence);
      }
      const PatchMatch match = correlate(seen, expected);
      if (contrast_of(seen) < kLeastContrast) continue;  // an empty part of the ground
      EXPECT_NEAR(scores.tag(0, 0).seen_share * 1024.0, match.num_samples, 2.0);
      EXPECT_NEAR(scores.tag(0, 0).correlation, match.correlation, 1e-3) << lens << " " << trial;
      num_agreeing += match.correlation > 0.9 ? 1 : 0;
    }
    EXPECT_GT(num_agreeing, 5) << lens;
  }
}

TEST_P(PatchKernels, SayNothingOfConstantPatchesAndTemplates) {
  const PatchGrid grid{.size = 16};
  const Eigen::Matrix3d M = camera_from_tag_plane({Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.5}}, 0.16);
  const Image<float> constant(kPatchImageWidth, kPatchImageHeight, 0.3F);
  std::vector<double> picture_reference(grid.num_samples()), same(grid.num_samples(), 0.1 + 0.2);
  RandomStream random(34);
  for (double& value : picture_reference) value = random.uniform();
  for (const bool is_image_constant : {false, true}) {
    PatchColumns columns;
    fill_columns(grid, all_cells(grid), is_image_constant ? picture_reference : same, &columns);
    const Image<float>& image = is_image_constant ? constant : pictures_[0];
    const PatchMatch match =
        match_of(sums_over(image, lenses()[0], M, grid, columns, std::numeric_limits<double>::infinity()));
    EXPECT_EQ(match.num_samples, 256);
    EXPECT_EQ(match.correlation, 0.0);
  }
}

}  // namespace
}  // namespace apriltrack
