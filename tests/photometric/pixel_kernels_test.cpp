#include "pixel_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "apriltrack/base/geman_mcclure.h"
#include "apriltrack/base/random.h"
#include "instruction_sets.h"
#include "tag_film.h"
#include "tag_pixels.h"
#include "tag_prediction.h"

// Every kernel on every instruction set of this machine, against its definition pixel by pixel in double.

namespace apriltrack {
namespace {

using test::TagFilm;

/// A tag that moves, turned by 0.5 rad, with rays on it, beside it, and where they meet its plane from
/// behind.
class PixelKernels : public ::testing::TestWithParam<std::int64_t> {
 protected:
  static constexpr ColourFactors kColours = {.gain = 0.55F, .black = 0.08F, .background = 0.3F};
  static constexpr float kReach = 2.5F;
  static constexpr float kInverseScale = 1.0F / 0.07F;

  PixelKernels() : film_(lens(), motion()), world_(film_.world()), prediction_(predicted(world_, film_)) {
    RandomStream random(1);
    const std::size_t size = padded(kCount);
    for (std::size_t i = 0; i < size; ++i) {
      const bool is_far = i % 17 == 0;
      const double reach = is_far ? 4.0 : 0.16;
      x_.push_back(static_cast<float>(random.uniform(-reach, reach)));
      y_.push_back(static_cast<float>(random.uniform(-reach, reach)));
      image_.push_back(static_cast<float>(random.uniform(0.0, 0.9)));
      inverse_sigma_.push_back(i < kCount ? static_cast<float>(random.uniform(0.2, 1.0)) : 0.0F);
      const PixelPrediction seen = prediction_.predict({x_[i], y_[i]}, jacobians_.emplace_back());
      light_.push_back(seen.light);
      presence_.push_back(seen.presence);
    }
  }
  double residual(std::size_t i) const {
    return static_cast<double>(kColours.gain * light_[i] + kColours.black * presence_[i] +
                               kColours.background * (1.0F - presence_[i]) - image_[i]);
  }
  RayColumns rays() const { return {x_.data(), y_.data(), x_.size()}; }
  SeenColumns seen() const {
    return {light_.data(), presence_.data(), image_.data(), inverse_sigma_.data(), x_.size()};
  }

  static constexpr std::size_t kCount = 701;
  const test::InstructionSet instruction_set_{GetParam()};
  TagFilm film_;
  PhotometricWorld world_;
  TagPrediction prediction_;
  std::vector<float> x_, y_, image_, inverse_sigma_, light_, presence_;
  std::vector<PixelJacobian> jacobians_;

 private:
  static CameraModel lens() { return {{400.0, 405.0, 155.0, 122.0}, NoDistortion{}}; }
  static Motion motion() {
    Motion motion;
    motion.T_end = {rotation_exp({0.5, 0.3, 0.1}), Eigen::Vector3d::Zero()};
    motion.position_m[0].rate_per_s = 0.9;
    motion.position_m[2] = {.offset = 0.62, .rate_per_s = 0.5, .waves = {}, .bursts = {}};
    motion.yaw_rad.rate_per_s = 2.0;
    return motion;
  }
  static TagPrediction predicted(PhotometricWorld& world, const TagFilm& film) {
    ViewPath path(film.truth, TagFilm::kExposure_s, world.mode);
    return {world, world.tags[0], path, 0};
  }
};

INSTANTIATE_TEST_SUITE_P(InstructionSets, PixelKernels, ::testing::ValuesIn(test::instruction_sets()),
                         test::instruction_set_name);

TEST_P(PixelKernels, PredictWhatTheDefinitionDoes) {
  ASSERT_GT(prediction_.num_instants(), 4U);
  std::vector<float> light(x_.size(), -1.0F), presence(x_.size(), -1.0F);
  predict_pixels(prediction_.texel_path(), rays(), light.data(), presence.data());
  int num_on_tag = 0, num_beside = 0;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    EXPECT_NEAR(light[i], light_[i], 2e-4) << i;
    EXPECT_NEAR(presence[i], presence_[i], 2e-4) << i;
    num_on_tag += presence_[i] > 0.9F ? 1 : 0;
    num_beside += presence_[i] == 0.0F ? 1 : 0;
  }
  EXPECT_GT(num_on_tag, 200);
  EXPECT_GT(num_beside, 50);
}

TEST_P(PixelKernels, SumColoursWithAndWithoutWeights) {
  std::vector<float> weights = image_;  // any numbers
  for (std::size_t i = kCount; i < weights.size(); ++i) weights[i] = 0.0F;
  for (const bool is_weighted : {false, true}) {
    std::array<double, 9> expected{};
    for (std::size_t i = 0; i < kCount; ++i) {
      const double s = inverse_sigma_[i], w = is_weighted ? weights[i] : s * s;
      const double l = light_[i], p = presence_[i], b = 1.0 - p, image = image_[i];
      const std::array terms = {l * l, l * p, l * b, p * p, p * b, b * b, l * image, p * image, b * image};
      for (std::size_t k = 0; k < terms.size(); ++k) expected[k] += w * terms[k];
    }
    const ColourSums sums = sum_colours(seen(), is_weighted ? weights.data() : nullptr);
    const std::array found = {sums.ll, sums.lp, sums.lb, sums.pp, sums.pb,
                              sums.bb, sums.li, sums.pi, sums.bi};
    for (std::size_t k = 0; k < found.size(); ++k)
      EXPECT_NEAR(found[k], expected[k], 1e-5 * expected[3]) << k;
  }
}

TEST_P(PixelKernels, WeighResidualsByGemanAndMcClure) {
  const GemanMcClure error(kReach);
  const double middle = kColours.black + 0.5F * kColours.gain;
  for (const float inverse_scale : {kInverseScale, 0.0F}) {
    std::vector<float> weights(x_.size(), -1.0F);
    const MisfitSums sums = weigh_residuals(seen(), kColours, inverse_scale, kReach, weights.data());
    MisfitSums expected;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const double r = residual(i), s = inverse_sigma_[i], r2 = std::pow(r * s * inverse_scale, 2);
      const double w = s * s * error.weight(r2), off = image_[i] - middle;
      EXPECT_NEAR(weights[i], w, 1e-4 * s * s) << i;
      expected.cost += 0.5 * error.penalty(r2);
      expected.weight += w;
      expected.image += w * off;
      expected.image2 += w * off * off;
      expected.residual2 += w * r * r;
    }
    EXPECT_NEAR(sums.cost, expected.cost, 1e-5 * expected.cost);
    EXPECT_NEAR(sums.weight, expected.weight, 1e-5 * expected.weight);
    EXPECT_NEAR(sums.image, expected.image, 1e-5 * expected.weight);
    EXPECT_NEAR(sums.image2, expected.image2, 1e-5 * expected.image2);
    EXPECT_NEAR(sums.residual2, expected.residual2, 1e-5 * expected.residual2);
  }
}

TEST_P(PixelKernels, MeasureSizesOfResiduals) {
  std::vector<float> sizes(x_.size(), -1.0F);
  residual_sizes(seen(), kColours, sizes.data());
  for (std::size_t i = 0; i < x_.size(); ++i)
    EXPECT_NEAR(sizes[i], std::abs(residual(i)) * inverse_sigma_[i], 1e-6) << i;
}

TEST_P(PixelKernels, FindTheSizeOfAnyRank) {
  std::vector<float> sizes(x_.size(), 0.0F);
  residual_sizes(seen(), kColours, sizes.data());
  std::vector<float> sorted = sizes;
  std::ranges::sort(sorted);
  for (const std::size_t rank : {std::size_t{0}, sorted.size() / 3, sorted.size() / 2, sorted.size() - 1})
    EXPECT_EQ(size_of_rank(sizes.data(), sizes.size(), rank), sorted[rank]) << rank;
}

TEST_P(PixelKernels, TellNoiseByWhatNeighboursDifferBy) {
  std::vector<float> weights(x_.size(), 0.0F);
  for (std::size_t i = 0; i < kCount; ++i) weights[i] = 0.5F + image_[i];
  double expected = 0.0;
  for (std::size_t i = 1; i < kCount; ++i)
    expected += 0.5 * std::min(weights[i - 1], weights[i]) * std::pow(residual(i) - residual(i - 1), 2);
  EXPECT_NEAR(noise_power(seen(), kColours, weights.data()), expected, 1e-5 * expected);
  EXPECT_EQ(noise_power({}, kColours, nullptr), 0.0);
}

TEST_P(PixelKernels, LineariseAsTheJacobiansDo) {
  const GemanMcClure error(kReach);
  Eigen::Matrix<double, 16, 16> expected = Eigen::Matrix<double, 16, 16>::Zero();
  for (std::size_t i = 0; i < kCount; ++i) {
    const double s = inverse_sigma_[i] * kInverseScale, r = residual(i) * s;
    Eigen::Matrix<double, 16, 1> row;
    for (std::size_t k = 0; k < 6; ++k) {
      const double a = kColours.gain, b = kColours.black - kColours.background;
      row[static_cast<Eigen::Index>(k)] =
          a * jacobians_[i].light_by_pose[k] + b * jacobians_[i].presence_by_pose[k];
      row[static_cast<Eigen::Index>(k) + 6] =
          a * jacobians_[i].light_by_rate[k] + b * jacobians_[i].presence_by_rate[k];
    }
    row[12] = light_[i];
    row[13] = presence_[i];
    row[14] = 1.0 - static_cast<double>(presence_[i]);
    row.head<15>() *= s;
    row[15] = r;
    expected += error.weight(r * r) * row * row.transpose();
  }
  const GramMatrix found = linearise_pixels(prediction_.texel_path(), rays(), image_.data(),
                                            inverse_sigma_.data(), kColours, kInverseScale, kReach);
  for (int i = 0; i < 16; ++i) {
    for (int k = 0; k < 16; ++k) {
      const double unit = std::sqrt(expected(i, i) * expected(k, k));
      EXPECT_NEAR(found[static_cast<std::size_t>(16 * i + k)], expected(i, k), 1e-3 * unit) << i << " " << k;
    }
  }
}

}  // namespace
}  // namespace apriltrack
