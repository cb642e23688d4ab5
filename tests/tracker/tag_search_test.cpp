#include "tag_search.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <vector>

#include "apriltrack/geometry/rotation.h"
#include "blur_film.h"

namespace apriltrack::test {
namespace {

/// The first frame of shaken_camera(): three tags can be read in it. It is looked at again and again, at
/// different times.
class SearchedFrame : public ::testing::Test {
 protected:
  SearchedFrame()
      : world_(film_.scene.camera, film_.scene.map, TrackMode::kEgo, 320, 240),
        reader_(options(film_), film_.scene.map, world_, 0.1),
        search_(reader_, world_) {
    EXPECT_EQ(film_.detections[0].size(), 3U);
  }

  static DetectorOptions options(const BlurFilm& film) {
    DetectorOptions options;
    options.response = film.scene.camera.response;
    return options;
  }
  Frame frame_at(double time_s) const {
    Frame frame = film_.frames[0].frame();
    frame.timestamp = Timestamp{static_cast<std::int64_t>(time_s * 1e9)};
    return frame;
  }
  MotionBelief expected(const Pose& pose) const {
    MotionBelief belief;
    belief.mean.pose = pose;
    belief.covariance = 1e-8 * Matrix12d::Identity();
    return belief;
  }
  MotionBelief where_it_is() const { return expected(film_.frames[0].truth); }
  /// The camera looks where no tag is.
  MotionBelief looking_away() const {
    return expected(film_.frames[0].truth * Pose(rotation_exp({0.0, 3.0, 0.0}), Eigen::Vector3d::Zero()));
  }
  BlurFrame looked(double time_s, const MotionBelief& belief) {
    BlurFrame result;
    search_.look(frame_at(time_s), belief, result);
    search_.were_read(result);
    return result;
  }
  BlurFrame looked_everywhere(double time_s) {
    BlurFrame result;
    search_.look_everywhere(frame_at(time_s), result);
    search_.were_read(result);
    return result;
  }

  const BlurFilm& film_ = shaken_camera();
  PhotometricWorld world_;
  TagReader reader_;
  TagSearch search_;
};

TEST_F(SearchedFrame, IsReadInFullWhereItIsLookedAtEverywhere) {
  const BlurFrame frame = looked_everywhere(10.0);
  EXPECT_TRUE(frame.is_searched);
  EXPECT_EQ(frame.read.size(), 3U);
}

TEST_F(SearchedFrame, IsReadWhereTagsAreExpectedInTurns) {
  looked_everywhere(10.0);
  std::set<int> read;
  for (int i = 1; i <= 6; ++i) {
    const BlurFrame frame = looked(10.0 + 0.03 * i, where_it_is());
    EXPECT_FALSE(frame.is_searched);
    EXPECT_GE(frame.read.size(), 1U);
    EXPECT_LT(frame.read.size(), 3U);  // three are more than 6 % of the image
    for (const TagObservation& seen : frame.read) read.insert(seen.tag_index);
  }
  EXPECT_EQ(read, std::set<int>({0, 1, 2}));
}

TEST_F(SearchedFrame, IsGlancedAtOnceASecondForWhatNothingExpects) {
  looked_everywhere(10.0);
  EXPECT_TRUE(looked(10.5, looking_away()).detections.empty());
  EXPECT_TRUE(looked(10.999, looking_away()).detections.empty());
  const BlurFrame glance = looked(11.0, looking_away());
  EXPECT_EQ(glance.read.size(), 3U);
  EXPECT_FALSE(glance.is_searched);  // not as finely as it can be
  EXPECT_TRUE(looked(11.9, looking_away()).detections.empty());
  EXPECT_EQ(looked(12.1, looking_away()).read.size(), 3U);
  looked_everywhere(12.9);  // is a glance, too
  EXPECT_TRUE(looked(13.3, looking_away()).detections.empty());
}

}  // namespace
}  // namespace apriltrack::test
