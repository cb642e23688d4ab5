// Mirrored pictures, and tags that are light on dark.

#include "apriltrack/detect/odd_pictures.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "apriltrack/image/reduced.h"
#include "apriltrack/tags/tag_family.h"
#include "plane_renderer.h"

namespace apriltrack {
namespace {

using ::testing::ElementsAre;

/// Two tags side by side on a grey wall, tilted.
GrayImage two_tags(const std::string& family, int width = 400, int height = 240) {
  const std::vector<TagPattern> patterns = {TagFamily::get(family).pattern(3),
                                            TagFamily::get(family).pattern(11)};
  constexpr double kEdge_m = 0.1, kApart_m = 0.2;
  const test::PlaneView view(width, {0.5 * width - 0.7, 0.5 * height + 0.3}, 0.6, 0.4, 0.7, 0.2);
  test::RenderOptions options;
  options.samples = 2;
  return test::render_plane(
      width, height, view,
      [&](double x, double y) {
        const double u = 2.0 * (x < 0.0 ? x + 0.5 * kApart_m : x - 0.5 * kApart_m) / kEdge_m,
                     v = 2.0 * y / kEdge_m;
        if (std::max(std::abs(u), std::abs(v)) > 1.95) return 0.5;
        return patterns[x < 0.0 ? 0 : 1].brightness(u, v);
      },
      options);
}

GrayImage mirrored(GrayImage image) {
  for (int y = 0; y < image.height(); ++y) std::reverse(image.row(y), image.row(y) + image.width());
  return image;
}

GrayImage inverted(GrayImage image) {
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) image(x, y) = static_cast<std::uint8_t>(255 - image(x, y));
  return image;
}

std::optional<OddPictures> found_in(const GrayImage& image, const std::string& family) {
  const std::vector<GrayImage> images = {image};
  return find_odd_pictures(images, {.families = {family}});
}

class OddPicturesOf : public ::testing::TestWithParam<const char*> {};

TEST_P(OddPicturesOf, AreKnownByTheTagsInThem) {
  const std::string family = GetParam();
  const GrayImage good = two_tags(family);
  for (const bool is_mirrored : {false, true}) {
    for (const bool is_inverted : {false, true}) {
      GrayImage image = good;
      if (is_mirrored) image = mirrored(std::move(image));
      if (is_inverted) image = inverted(std::move(image));
      const auto odd = found_in(image, family);
      ASSERT_EQ(odd.has_value(), is_mirrored || is_inverted) << is_mirrored << is_inverted;
      if (!odd) continue;
      EXPECT_EQ(odd->are_mirrored, is_mirrored);
      EXPECT_EQ(odd->are_inverted, is_inverted);
      EXPECT_THAT(odd->tags, ElementsAre(TagKey{family, 3}, TagKey{family, 11}));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, OddPicturesOf,
                         ::testing::Values("tag16h5", "tag36h11", "tag36h11b2", "tagStandard41h12"));

TEST(OddPictures, AreFoundInReducedCopies) {
  const std::vector<GrayImage> small = {
      reduced_copy(mirrored(two_tags("tag36h11", 1600, 960)).view(), 100'000)};
  EXPECT_EQ(small[0].width(), 400);
  EXPECT_EQ(small[0].height(), 240);
  const auto odd = find_odd_pictures(small, {});
  ASSERT_TRUE(odd);
  EXPECT_TRUE(odd->are_mirrored && !odd->are_inverted);
}

TEST(ReducedCopy, IsTheMeanOfFourPixels) {
  GrayImage image(5, 4, 0);
  image(0, 0) = 10;
  image(1, 0) = 20;
  image(0, 1) = 30;
  image(1, 1) = 43;
  const GrayImage half = reduced_copy(image.view(), 19);
  ASSERT_EQ(half.width(), 2);
  ASSERT_EQ(half.height(), 2);
  EXPECT_EQ(half(0, 0), 26);  // 25.75
  EXPECT_EQ(half(1, 1), 0);
  EXPECT_EQ(reduced_copy(image.view(), 20).width(), 5);
}

}  // namespace
}  // namespace apriltrack
