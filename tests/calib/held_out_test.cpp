#include "photometric/held_out.h"

#include <gtest/gtest.h>

#include <cmath>

namespace apriltrack {
namespace {

using Squares = std::vector<std::optional<double>>;

/// Two tags by turns.
std::vector<PhotometricView> some_views(std::size_t count) {
  std::vector<PhotometricView> views(count);
  for (std::size_t i = 0; i < count; ++i) views[i].tag = static_cast<int>(i % 2);
  return views;
}

TEST(HeldOut, IsComparedOnThePicturesOfBoth) {
  // The third is explained after alone: it says nothing of the map before.
  const auto compared =
      compare_held_out(some_views(4), Squares{12.0, 6.0, std::nullopt, 6.0}, Squares{6.0, 3.0, 600.0, 3.0});
  ASSERT_TRUE(compared.has_value());
  EXPECT_NEAR(compared->before, std::sqrt(24.0 / 18.0), 1e-12);
  EXPECT_NEAR(compared->after, std::sqrt(12.0 / 18.0), 1e-12);
  EXPECT_TRUE(compared->lost_tags.empty());
}

TEST(HeldOut, CountsWhatIsLostAsBarelyNoOutlier) {
  const auto compared =
      compare_held_out(some_views(4), Squares{6.0, 6.0, 6.0, 6.0}, Squares{3.0, 3.0, 3.0, std::nullopt});
  ASSERT_TRUE(compared.has_value());
  EXPECT_NEAR(compared->before, 1.0, 1e-12);
  EXPECT_NEAR(compared->after, std::sqrt((9.0 + 25.0 * 3.0) / 24.0), 1e-12);
  EXPECT_TRUE(compared->lost_tags.empty()) << "of two pictures, one may be lost by chance";
}

TEST(HeldOut, NamesTagsMostOfWhosePicturesAreLost) {
  Squares before(12, 60.0), after(12, 1.0);
  for (const std::size_t i : {1U, 3U, 5U, 7U}) after[i] = std::nullopt;
  auto compared = compare_held_out(some_views(12), before, after);
  ASSERT_TRUE(compared.has_value());
  EXPECT_LT(compared->after, compared->before);
  EXPECT_EQ(compared->lost_tags, std::vector<int>{1});
  after[7] = 1.0;  // three of six
  EXPECT_TRUE(compare_held_out(some_views(12), before, after)->lost_tags.empty());
}

TEST(HeldOut, TellsHowClearAGainIs) {
  // Two pictures a moment, which gain or lose together: 4, 4, 4 and -2, of squares that fall by 10 in all.
  std::vector<PhotometricView> views = some_views(8);
  for (std::size_t i = 0; i < views.size(); ++i) views[i].moment = static_cast<int>(i / 2);
  const auto compared = compare_held_out(views, Squares{6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0},
                                         Squares{4.0, 4.0, 4.0, 4.0, 4.0, 4.0, 7.0, 7.0});
  ASSERT_TRUE(compared.has_value());
  EXPECT_EQ(compared->moments, 4);
  EXPECT_NEAR(compared->gain_in_errors, 2.5 / std::sqrt((3.0 * 2.25 + 20.25) / (4.0 * 3.0)), 1e-12);
}

TEST(HeldOut, SaysNothingWherePicturesOfBothAreWanting) {
  EXPECT_FALSE(compare_held_out(some_views(2), Squares{std::nullopt, 1.0}, Squares{1.0, std::nullopt}));
}

}  // namespace
}  // namespace apriltrack
