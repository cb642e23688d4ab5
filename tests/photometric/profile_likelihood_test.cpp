#include "apriltrack/photometric/profile_likelihood.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/photometric/evidence.h"
#include "apriltrack/photometric/patch.h"

namespace apriltrack {
namespace {

/// log of the density of `image` = gain * pattern + offset + N(0, exp(2 log_sigma)), sample by sample.
double gaussian_log_likelihood(const std::vector<double>& image, const std::vector<double>& pattern,
                               const std::array<double, 3>& gain_offset_log_sigma) {
  const auto [gain, offset, log_sigma] = gain_offset_log_sigma;
  double sum = 0.0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const double r = (image[i] - gain * pattern[i] - offset) / std::exp(log_sigma);
    sum -= 0.5 * (r * r + std::log(2.0 * std::numbers::pi)) + log_sigma;
  }
  return sum;
}

/// Its maximum, by looking: a grid about the best so far, closer whenever its middle is the best.
double brute_force_maximum(const std::vector<double>& image, const std::vector<double>& pattern) {
  std::array<double, 3> best = {0.0, 0.0, 0.0};
  double most = gaussian_log_likelihood(image, pattern, best);
  for (double step = 0.5; step > 1e-5;) {
    const std::array<double, 3> middle = best;
    for (int cell = 0; cell < 27; ++cell) {
      std::array<double, 3> place = middle;
      place[0] += step * (cell % 3 - 1);
      place[1] += step * (cell / 3 % 3 - 1);
      place[2] += step * (cell / 9 - 1);
      const double value = gaussian_log_likelihood(image, pattern, place);
      if (value > most) {
        most = value;
        best = place;
      }
    }
    if (best == middle) step *= 0.6;
  }
  return most;
}

double variance_of(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(values.size());
  return squares / n - sum * sum / (n * n);
}

TEST(ProfileLogLikelihood, IsTheGaussianLikelihoodAtItsMaximum) {
  RandomStream random(11);
  double least = 1.0, most = 0.0;
  for (const double noise : {3.0, 1.0, 0.4, 0.1}) {
    for (int run = 0; run < 4; ++run) {
      std::vector<double> pattern(25), image(25);
      for (std::size_t i = 0; i < pattern.size(); ++i) {
        pattern[i] = random.normal();
        image[i] = 0.8 * pattern[i] + 0.3 + noise * random.normal();
      }
      const double c = correlate(image, pattern).correlation;
      const double n = 25.0;
      // What the best Gaussian explains of nothing: the constant that the header leaves out.
      const double of_no_pattern =
          -0.5 * n * std::log(2.0 * std::numbers::pi * std::numbers::e * variance_of(image));
      EXPECT_NEAR(brute_force_maximum(image, pattern), profile_log_likelihood(c, n, 0.0) + of_no_pattern,
                  1e-4)
          << "c = " << c;
      least = std::min(least, std::abs(c));
      most = std::max(most, std::abs(c));
    }
  }
  EXPECT_LT(least, 0.3);  // from what hardly fits to what fits well
  EXPECT_GT(most, 0.98);
}

/// kappa as the noise that it stands for: what is left of the image's variance grows by its share.
TEST(ProfileLogLikelihood, KappaIsVarianceThatNothingExplains) {
  RandomStream random(12);
  constexpr double kKappa = 0.05;
  constexpr std::size_t kCount = 200'000;
  std::vector<double> pattern(kCount), image(kCount), spoiled(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    pattern[i] = random.normal();
    image[i] = pattern[i] + 0.5 * random.normal();
  }
  const double sigma = std::sqrt(kKappa * variance_of(image));
  for (std::size_t i = 0; i < kCount; ++i) spoiled[i] = image[i] + sigma * random.normal();
  const double c = correlate(image, pattern).correlation;
  const double of_spoiled = correlate(spoiled, pattern).correlation;
  // Shares of the spoiled image's variance against shares of the clean one's: the constant between the uses.
  const double expected = profile_log_likelihood(of_spoiled, 1.0, 0.0) - 0.5 * std::log(1.0 + kKappa);
  EXPECT_NEAR(profile_log_likelihood(c, 1.0, kKappa), expected, 5e-3);
  EXPECT_GT(std::abs(profile_log_likelihood(c, 1.0, 0.0) - expected), 0.05);
}

TEST(LogLikelihoodOfEvidence, ATagThatExplainsNothingCostsFiveNats) {
  const TagEvidence hidden{.num_pixels = 700, .area_px = 9000.0, .correlation = 0.0};
  const TagEvidence seen{.num_pixels = 700, .area_px = 9000.0, .correlation = 1.0};
  EXPECT_NEAR(log_likelihood({hidden}), -170.0 * std::log(1.03), 1e-9);
  EXPECT_NEAR(log_likelihood({seen}), -170.0 * std::log(0.03), 1e-9);
  EXPECT_NEAR(log_likelihood({seen, hidden, hidden}), log_likelihood({seen}) - 2.0 * 170.0 * std::log(1.03),
              1e-9);
  EXPECT_EQ(log_likelihood({}), 0.0);
}

}  // namespace
}  // namespace apriltrack
