// The loop over a source's frames: its counts, its progress and its end do not depend on the threads at work.

#include "apriltrack/source/detect_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Images of one grey level each; 0: an image that cannot be read. With a stripe, lest they are blank.
class ListedFrames : public FrameSource {
 public:
  explicit ListedFrames(std::vector<int> levels, int width = 64)
      : levels_(std::move(levels)), width_(width) {}
  std::optional<SourceFrame> next() override {
    if (next_ == levels_.size()) return std::nullopt;
    SourceFrame frame;
    frame.name = std::to_string(next_);
    frame.timestamp = Timestamp{static_cast<std::int64_t>(next_) * 100'000'000};
    const int level = levels_[next_++];
    if (level == 0) {
      frame.error = "is cut short";
      return frame;
    }
    frame.pixels = GrayImage(width_, 48, static_cast<std::uint8_t>(level));
    for (int x = 0; x < width_; ++x)
      for (int y = 0; y < 16; ++y) frame.pixels(x, y) = 255;
    return frame;
  }
  std::optional<std::size_t> num_frames() const override { return levels_.size(); }
  std::string name() const override { return "listed"; }

 private:
  std::vector<int> levels_;
  int width_;
  std::size_t next_ = 0;
};

TEST(DetectFrames, CountsAndNamesWhatIsOdd) {
  for (const int threads : {1, 3}) {
    ListedFrames source({10, 20, 20, 0, 30, 30, 30});
    DetectFramesOptions options;
    options.detector = DetectorOptions();
    options.num_threads = threads;
    std::vector<std::string> names;
    const FrameCounts counts = detect_frames(
        source, options, [&](const DetectedFrame& frame) { names.push_back(frame.source.name); });
    EXPECT_THAT(names, ElementsAre("0", "1", "2", "3", "4", "5", "6"));
    EXPECT_EQ(counts.readable, 6U);
    EXPECT_EQ(counts.unreadable, 1U);
    EXPECT_EQ(counts.copies, 3U);
    EXPECT_EQ(counts.first_copy, "2");
    EXPECT_THAT(counts.warnings(),
                ElementsAre("1 of 7 frames are left out; the first: 3: is cut short", HasSubstr("3 of 6")));
  }
}

TEST(DetectFrames, StopsBeforeTheNextFrameAndTellsEachStep) {
  ListedFrames source({10, 20, 30, 40});
  DetectFramesOptions options;
  int steps = 0, seen = 0;
  std::string task;
  options.task = "look";
  options.progress = [&](const std::string& what, std::optional<std::size_t> all) {
    task = what + " " + std::to_string(all.value_or(0));
    return ProgressStep([&steps] { ++steps; });
  };
  options.should_stop = [&] { return seen == 2; };
  const FrameCounts counts = detect_frames(source, options, [&](const DetectedFrame&) { ++seen; });
  EXPECT_TRUE(counts.is_interrupted);
  EXPECT_EQ(counts.readable, 2U);
  EXPECT_EQ(steps, 2);
  EXPECT_EQ(task, "look 4");
}

TEST(DetectFrames, NoReadableFrameIsAnError) {
  ListedFrames source({0, 0});
  EXPECT_THROW(detect_frames(source, {}, [](const DetectedFrame&) {}), Error);
  ListedFrames none({});
  EXPECT_THROW(detect_frames(none, {}, [](const DetectedFrame&) {}), Error);
}

TEST(DetectFrames, ImagesOfAnotherSizeThanTheCamerasAreAnError) {
  const Camera camera{.name = "cam0",
                      .model = CameraModel(Pinhole{500, 500, 319.5, 239.5}, NoDistortion{}),
                      .width = 640,
                      .height = 480};
  ListedFrames source({10, 20});
  DetectFramesOptions options;
  options.camera = &camera;
  EXPECT_THROW(detect_frames(source, options, [](const DetectedFrame&) {}), Error);
}

}  // namespace
}  // namespace apriltrack
