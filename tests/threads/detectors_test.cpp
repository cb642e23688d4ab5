#include <gtest/gtest.h>

#include <array>
#include <string>

#include "apriltrack/detect/detector.h"
#include "apriltrack/tags/tag_family.h"
#include "detect/plane_renderer.h"
#include "side_by_side.h"

namespace apriltrack {
namespace {

constexpr double kSize_m = 0.16;
constexpr int kSide_px = 120;
// Some twice: two threads then ask for one family before anyone has built it.
const std::array<std::string, 6> kFamilies = {"tag36h11", "tag25h9",    "tag36h11",
                                              "tag16h5",  "tag36h11b2", "tag25h9"};

int id_of(std::size_t thread, std::size_t picture) {
  return static_cast<int>(3 + 2 * thread + 5 * picture);
}

GrayImage picture_of_tag(const std::string& family, int id, std::size_t number) {
  const TagPattern pattern = TagFamily::get(family).pattern(id);
  const double focal_px = 300.0;
  const test::PlaneView view(focal_px, {59.3, 60.2}, focal_px * kSize_m / 62.0, 0.3, 1.1,
                             0.2 + 0.9 * static_cast<double>(number));
  test::RenderOptions options;
  options.samples = 2;
  options.seed = static_cast<std::uint64_t>(id);
  return test::render_plane(
      kSide_px, kSide_px, view,
      [&](double x, double y) { return pattern.brightness(2.0 * x / kSize_m, 2.0 * y / kSize_m); }, options);
}

/// All that one thread finds, its families, pictures and detector made by itself.
std::vector<std::vector<Detection>> work_of(std::size_t thread) {
  DetectorOptions options;
  options.families = {kFamilies[thread]};
  Detector detector(options);
  std::vector<std::vector<Detection>> found;
  for (std::size_t picture = 0; picture < 3; ++picture) {
    found.push_back(
        detector.detect(picture_of_tag(kFamilies[thread], id_of(thread, picture), picture).view()));
  }
  return found;
}

TEST(DetectorsSideBySide, FindTheSameAsOneByOne) {
  const auto together =
      test::side_by_side(kFamilies.size(), work_of);  // first: the families are not built yet
  const auto alone = test::one_by_one(kFamilies.size(), work_of);
  for (std::size_t thread = 0; thread < kFamilies.size(); ++thread) {
    for (std::size_t picture = 0; picture < alone[thread].size(); ++picture) {
      SCOPED_TRACE(kFamilies[thread] + ", picture " + std::to_string(picture));
      const std::vector<Detection>& expected = alone[thread][picture];
      const std::vector<Detection>& found = together[thread][picture];
      ASSERT_EQ(expected.size(), 1U);
      EXPECT_EQ(expected[0].tag, (TagKey{kFamilies[thread], id_of(thread, picture)}));
      ASSERT_EQ(found.size(), 1U);
      EXPECT_EQ(found[0].tag, expected[0].tag);
      EXPECT_EQ(found[0].corners_px, expected[0].corners_px);
      EXPECT_EQ(found[0].hamming, expected[0].hamming);
      EXPECT_EQ(found[0].decision_margin, expected[0].decision_margin);
    }
  }
}

}  // namespace
}  // namespace apriltrack
