// Where a camera stood, from what it saw.
#include "apriltrack/calib/camera_places.h"

#include <gmock/gmock.h>

namespace apriltrack {
namespace {

using ::testing::ElementsAre;

constexpr double kSamePlace_px = 1.0;

/// What one camera sees of these tags from a place: each where no other is, other places 50 px aside.
std::vector<TagSight> sights_of(const std::vector<int>& tags, int place) {
  std::vector<TagSight> sights;
  for (const int tag : tags) {
    const Eigen::Vector2d first(100.0 * tag + 50.0 * place, 200.0);
    sights.push_back({0,
                      tag,
                      {first, first + Eigen::Vector2d(40.0, 0.0), first + Eigen::Vector2d(40.0, -40.0),
                       first + Eigen::Vector2d(0.0, -40.0)}});
  }
  return sights;
}

std::vector<std::size_t> places_of(const std::vector<std::vector<TagSight>>& moments) {
  return find_camera_places(moments, kSamePlace_px);
}

TEST(CameraPlaces, AreToldApartByWhereTagsLie) {
  EXPECT_THAT(places_of({sights_of({0, 1}, 0), sights_of({0, 1}, 1), sights_of({0, 1}, 0)}),
              ElementsAre(0, 1, 0));
}

TEST(CameraPlaces, OfTagsThatComeAndGoAreOne) {
  EXPECT_THAT(places_of({sights_of({0, 1, 2}, 0), sights_of({0, 1}, 0), sights_of({0, 1, 3}, 0)}),
              ElementsAre(0, 0, 0));
}

TEST(CameraPlaces, WithoutACommonSightAreJoinedByALaterMomentThatHasAll) {
  EXPECT_THAT(places_of({sights_of({0, 1}, 0), sights_of({2, 3}, 0), sights_of({0, 1, 2, 3}, 0)}),
              ElementsAre(0, 0, 0));
}

/// The second is one with the third only by what that has of the fourth.
TEST(CameraPlaces, AreJoinedByWhatOthersBring) {
  EXPECT_THAT(places_of({sights_of({0, 1}, 0), sights_of({4, 5}, 0), sights_of({0, 1, 2, 3}, 0),
                         sights_of({2, 3, 4, 5}, 0)}),
              ElementsAre(0, 0, 0, 0));
}

TEST(CameraPlaces, AreNotJoinedWhereTagsLieElsewhere) {
  std::vector<TagSight> mixed = sights_of({0, 1}, 0);
  for (const TagSight& sight : sights_of({2, 3}, 1)) mixed.push_back(sight);
  EXPECT_THAT(places_of({sights_of({0, 1}, 0), sights_of({2, 3}, 0), mixed}), ElementsAre(0, 1, 0));
}

}  // namespace
}  // namespace apriltrack
