// Corners held against the resolution that the camera file states.

#include "apriltrack/detect/picture_size.h"

#include <gmock/gmock.h>

#include <utility>

#include "support/error_message.h"

namespace apriltrack {
namespace {

using test::message_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

CameraRig rig_of(int width, int height) {
  CameraRig rig;
  rig.cameras.push_back(Camera{
      .model = CameraModel({500.0, 502.0, 319.5, 239.5}, NoDistortion()), .width = width, .height = height});
  return rig;
}

Detection square_at(double left_px, double top_px, double edge_px) {
  const double right = left_px + edge_px, bottom = top_px + edge_px;
  Detection detection;
  detection.tag = {"tag36h11", 3};
  detection.corners_px = {
      Eigen::Vector2d(left_px, bottom), {right, bottom}, {right, top_px}, {left_px, top_px}};
  return detection;
}

/// Tags that wander over a picture of this size from side to side.
std::vector<FrameDetections> frames_of(int width, int height, int num_frames = 40) {
  constexpr double kEdge_px = 30.0;
  std::vector<FrameDetections> frames;
  for (int i = 0; i < num_frames; ++i) {
    const double share = i / (num_frames - 1.0);
    frames.push_back({Timestamp{1000 + i}, "cam0", {}});
    frames.back().detections.push_back(
        square_at(share * (width - 1 - kEdge_px), share * (height - 1 - kEdge_px), kEdge_px));
  }
  return frames;
}

TEST(PictureSize, CornersOfAPictureOfTheCamerasSizeFit) {
  EXPECT_THAT(check_picture_sizes(frames_of(640, 480), rig_of(640, 480)), IsEmpty());
}

TEST(PictureSize, CornersThatTheBorderCutsOffMayLieOutside) {
  std::vector<FrameDetections> frames = frames_of(640, 480);
  for (FrameDetections& frame : frames) {
    frame.detections.push_back(square_at(-27.0, 460.0, 40.0));  // 500 is 4 % past the border
    frame.detections.push_back(square_at(625.0, -20.0, 40.0));
  }
  EXPECT_THAT(check_picture_sizes(frames, rig_of(640, 480)), IsEmpty());
}

TEST(PictureSize, PicturesTwiceAsLargeAreRefusedWithTheIntrinsicsOfThese) {
  const std::vector<FrameDetections> frames = frames_of(1280, 960);
  // A pixel of the camera is two of the pictures: its centre (319.5, 239.5) lies between them, at 639.5,
  // 479.5.
  EXPECT_THAT(message_of([&] { check_picture_sizes(frames, rig_of(640, 480)); }),
              AllOf(HasSubstr("tag36h11/3"), HasSubstr("camera 'cam0' is calibrated for 640 x 480"),
                    HasSubstr("1020 ns"), HasSubstr("(1247, 935)"), HasSubstr("scaled by 2"),
                    HasSubstr("intrinsics: [1000, 1004, 639.5, 479.5] and resolution: [1280, 960]")));
}

TEST(PictureSize, MixedPicturesAreRefusedAndNameThePlaceOfTheFirst) {
  std::vector<FrameDetections> frames = frames_of(640, 480);
  for (FrameDetections frame : frames_of(1280, 960)) {
    frame.timestamp.ns += 1000;
    frames.push_back(frame);
  }
  const auto place = [](const FrameDetections& frame, const Detection&) {
    return "corners.csv:" + std::to_string(frame.timestamp.ns);
  };
  EXPECT_THAT(message_of([&] { check_picture_sizes(frames, rig_of(640, 480), place); }),
              AllOf(HasSubstr("corners.csv:20"), HasSubstr("of 80 frames")));
}

TEST(PictureSize, OfPicturesThatAreNoScaledOnesNoScaleIsTold) {
  EXPECT_THAT(message_of([&] { check_picture_sizes(frames_of(480, 1900), rig_of(640, 480)); }),
              AllOf(HasSubstr("Give the camera file"), Not(HasSubstr("intrinsics:"))));
}

TEST(PictureSize, AStrayFrameIsWarnedOf) {
  std::vector<FrameDetections> frames = frames_of(640, 480);
  frames[7].detections.push_back(square_at(900.0, 100.0, 40.0));
  EXPECT_THAT(check_picture_sizes(frames, rig_of(640, 480)),
              ElementsAre(AllOf(HasSubstr("1 of 40 frames"), HasSubstr("1007 ns"), HasSubstr("640 x 480"))));
}

TEST(PictureSize, PicturesHalfAsLargeAreDoubted) {
  EXPECT_THAT(check_picture_sizes(frames_of(320, 240), rig_of(640, 480)),
              ElementsAre(AllOf(HasSubstr("320 x 240"), HasSubstr("[250, 251, 159.5, 119.5]"))));
}

TEST(PictureSize, ACornerOfThePictureAloneIsNoDoubt) {
  std::vector<FrameDetections> frames = frames_of(300, 100);  // neither shape nor sides of a scaled picture
  EXPECT_THAT(check_picture_sizes(frames, rig_of(640, 480)), IsEmpty());
}

/// Three tags, before which the camera moves by `speed_px` a frame.
std::vector<FrameDetections> frames_of_three(double speed_px) {
  std::vector<FrameDetections> frames;
  for (int i = 0; i < 40; ++i) {
    frames.push_back({Timestamp{1000 + i}, "cam0", {}});
    const double shift_px = speed_px * (i % 20);
    int id = 0;
    for (const auto& [left_px, top_px] : {std::pair(60.0, 40.0), {230.0, 280.0}, {420.0, 400.0}}) {
      frames.back().detections.push_back(square_at(left_px + shift_px, top_px, 50.0));
      frames.back().detections.back().tag.id = id++;
    }
  }
  return frames;
}

/// As pictures of 1 / `scale` of the width have them, about the upper left corner of the first pixel.
void shrink(FrameDetections& frame, double scale) {
  for (Detection& detection : frame.detections)
    for (Eigen::Vector2d& corner : detection.corners_px)
      corner = ((corner.array() + 0.5) / scale - 0.5).matrix();
}

TEST(PictureSize, PicturesThatChangeTheirSizeAreRefused) {
  for (const double scale : {1.25, 2.0}) {
    std::vector<FrameDetections> shrinking = frames_of_three(6.0), growing = shrinking;
    for (std::size_t i = 0; i < 40; ++i) shrink(i < 25 ? growing[i] : shrinking[i], scale);
    for (const auto* frames : {&shrinking, &growing})
      EXPECT_THAT(message_of([&] { check_picture_sizes(*frames, rig_of(640, 480)); }),
                  AllOf(HasSubstr("change their size between 1024 and 1025 ns"), HasSubstr("640 x 480")))
          << scale;
  }
}

TEST(PictureSize, NoMovementLooksLikeAnotherSize) {
  EXPECT_THAT(check_picture_sizes(frames_of_three(6.0), rig_of(640, 480)), IsEmpty());
  EXPECT_THAT(check_picture_sizes(frames_of_three(9.0), rig_of(640, 480)), IsEmpty()) << "and back at once";
  std::vector<FrameDetections> zoomed = frames_of_three(0.0);
  for (std::size_t i = 20; i < 40; ++i) {
    for (Detection& detection : zoomed[i].detections)
      for (Eigen::Vector2d& corner : detection.corners_px)
        corner = Eigen::Vector2d(320.0, 240.0) + 0.5 * (corner - Eigen::Vector2d(320.0, 240.0));
  }
  EXPECT_THAT(check_picture_sizes(zoomed, rig_of(640, 480)), IsEmpty()) << "half as large about the middle";
}

TEST(PictureSize, ACameraWithoutResolutionTakesAnyCorners) {
  EXPECT_THAT(check_picture_sizes(frames_of(1280, 960), rig_of(0, 0)), IsEmpty());
}

}  // namespace
}  // namespace apriltrack
