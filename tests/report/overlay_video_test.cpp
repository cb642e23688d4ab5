// Videos are decoded again and judged by their pixels.
#include "apriltrack/report/overlay_video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgproc.hpp>

#include "apriltrack/io/atomic_file.h"
#include "decoded_video.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

constexpr double kNowhere_px = std::numeric_limits<double>::quiet_NaN();

ColouredOutline outlined_box(double left, double top, double right, double bottom, Colour colour) {
  return {{Eigen::Vector2d(left, bottom), {right, bottom}, {right, top}, {left, top}}, colour};
}

/// A video of one frame of even grey.
std::filesystem::path video_of(int width, int height, std::uint8_t grey,
                               std::vector<ColouredOutline> outlines, const std::string& caption = "",
                               Colour caption_colour = {}) {
  const auto file = test::temporary_folder() / "overlay.mp4";
  const GrayImage image(width, height, grey);
  OverlayVideo video(file, width, height, 30.0);
  video.add({image.view(), std::move(outlines), caption, caption_colour});
  video.close();
  return file;
}

test::DecodedFrame one_frame(const std::filesystem::path& file) {
  const auto video = test::decode_video(file);
  if (video.frames.size() != 1) throw std::runtime_error("not one frame");
  return video.frames[0];
}

/// The middle of what is brighter than `grey` in a profile of luma, the first pixel's centre at 0.
double middle_of_bright(const cv::Mat& profile, double grey) {
  double sum = 0.0;
  double weighted = 0.0;
  for (int i = 0; i < static_cast<int>(profile.total()); ++i) {
    const double more = std::max(0.0, profile.at<std::uint8_t>(i) - grey - 6.0);  // 6: noise of the codec
    sum += more;
    weighted += more * i;
  }
  return weighted / sum;
}

TEST(OverlayVideo, EveryFrameComesBackInItsPlaceAndTime) {
  const auto file = test::temporary_folder() / "video.mp4";
  constexpr int kFrames = 80;
  constexpr double kRate = 30000.0 / 1001.0;
  OverlayVideo video(file, 161, 121, kRate);
  const int width = video.width();
  const int height = video.height();
  for (int i = 0; i < kFrames; ++i) {
    const GrayImage image(161, 121, static_cast<std::uint8_t>(20 + 60 * (i % 4)));
    video.add({image.view(), {}, "frame", kBlue});
  }
  video.close();
  EXPECT_EQ(width, 162) << "made even";
  EXPECT_EQ(height % 2, 0);
  EXPECT_GE(height, 121 + 20);
  const auto decoded = test::decode_video(file);
  EXPECT_EQ(decoded.codec, "h264");
  EXPECT_EQ(decoded.pixel_format, "yuv420p");
  EXPECT_NEAR(decoded.duration_s, kFrames / kRate, 1e-3);
  ASSERT_EQ(decoded.frames.size(), static_cast<std::size_t>(kFrames));
  for (int i = 0; i < kFrames; ++i) {
    const auto& frame = decoded.frames[static_cast<std::size_t>(i)];
    EXPECT_NEAR(frame.time_s, i / kRate, 1e-3);
    ASSERT_EQ(frame.luma.size(), cv::Size(width, height));
    const cv::Rect picture(0, height - 121, 161, 121);
    EXPECT_NEAR(cv::mean(frame.bgr(picture))[1], 20 + 60 * (i % 4), 4.0) << i;
  }
}

TEST(OverlayVideo, IndexComesBeforeThePictures) {
  const auto names = test::box_names(video_of(64, 64, 100, {}));
  const auto index = std::ranges::find(names, "moov");
  const auto pictures = std::ranges::find(names, "mdat");
  ASSERT_NE(pictures, names.end());
  EXPECT_LT(index, pictures);
}

TEST(OverlayVideo, WholeCoordinatesAreCentresOfPixels) {
  constexpr double kMaxError_px = 0.2;  // OpenCV's own rounding: 0.15; a wrong convention is 0.5 off
  constexpr int kGrey = 40;
  for (const double shift : {0.0, 0.5}) {
    const auto file = video_of(320, 240, kGrey, {outlined_box(60 + shift, 50, 250, 180 + shift, kYellow)});
    const cv::Mat luma = one_frame(file).luma;
    const cv::Mat picture = luma.rowRange(luma.rows - 240, luma.rows);
    const double dark = picture.at<std::uint8_t>(20, 20);
    const cv::Mat row = picture(cv::Rect(0, 120, 160, 1)).clone();
    const cv::Mat column = picture(cv::Rect(150, 115, 1, 120)).clone();
    EXPECT_NEAR(middle_of_bright(row, dark), 60 + shift, kMaxError_px);
    EXPECT_NEAR(115 + middle_of_bright(column, dark), 180 + shift, kMaxError_px);
  }
}

TEST(OverlayVideo, OutlinesHaveTheirColours) {
  constexpr double kMaxError = 28.0;  // of 255: the codec's loss, on lines 4 pixels wide
  const Colour colours[] = {kBluishGreen, kVermilion, kBlue};
  std::vector<ColouredOutline> outlines;
  for (int i = 0; i < 3; ++i)
    outlines.push_back(outlined_box(100 + 300 * i, 40, 300 + 300 * i, 160, colours[i]));
  const cv::Mat bgr = one_frame(video_of(1120, 200, 128, outlines)).bgr;
  const int top = bgr.rows - 200;
  for (int i = 0; i < 3; ++i) {
    const cv::Vec3b pixel = bgr.at<cv::Vec3b>(top + 100, 100 + 300 * i);
    EXPECT_NEAR(pixel[0], colours[i].blue, kMaxError) << i;
    EXPECT_NEAR(pixel[1], colours[i].green, kMaxError) << i;
    EXPECT_NEAR(pixel[2], colours[i].red, kMaxError) << i;
    const cv::Vec3b inside = bgr.at<cv::Vec3b>(top + 100, 200 + 300 * i);
    EXPECT_LT(cv::norm(inside, cv::Vec3b(128, 128, 128)), 15.0) << "an outline is not filled";
  }
}

TEST(OverlayVideo, CornersBehindTheCameraDrawNothing) {
  const std::string empty = read_file(video_of(320, 240, 90, {}));
  auto nowhere = outlined_box(50, 50, 200, 200, kVermilion);
  nowhere.corners_px[2].y() = kNowhere_px;
  EXPECT_EQ(read_file(video_of(320, 240, 90, {nowhere})), empty);
  for (const double far : {1e4, -1e4, 1e300, std::numeric_limits<double>::infinity()}) {
    auto outline = outlined_box(50, 50, 200, 200, kVermilion);
    outline.corners_px[1].x() = far;
    EXPECT_EQ(read_file(video_of(320, 240, 90, {outline})), empty) << far;
  }
  auto half_outside = outlined_box(-200, 50, 200, 500, kVermilion);
  EXPECT_NE(read_file(video_of(320, 240, 90, {half_outside})), empty);
}

TEST(OverlayVideo, CaptionIsReadableOnBlackAndOnWhite) {
  for (const int grey : {0, 255}) {
    const auto file =
        video_of(320, 240, static_cast<std::uint8_t>(grey), {}, "frame 12  tracked", kBluishGreen);
    const cv::Mat bgr = one_frame(file).bgr;
    const cv::Mat bar = bgr.rowRange(0, bgr.rows - 240);
    cv::Mat luma;
    cv::cvtColor(bar, luma, cv::COLOR_BGR2GRAY);
    EXPECT_GT(cv::countNonZero(luma > 200), 100) << "bright letters";
    EXPECT_GT(cv::countNonZero(luma < 60), bar.rows * bar.cols / 2) << "on a dark bar";
    const cv::Mat letters = luma.colRange(260, 320) > 100;
    EXPECT_EQ(cv::countNonZero(letters), 0) << "no longer than its words";
    EXPECT_LT(cv::norm(bar.at<cv::Vec3b>(bar.rows / 2, bar.rows / 2), cv::Vec3b(115, 158, 0)), 40.0)
        << "a block of the colour";
  }
}

TEST(OverlayVideo, LongCaptionEndsBeforeTheEdge) {
  const cv::Mat bgr = one_frame(video_of(320, 240, 100, {}, std::string(300, 'w'))).bgr;
  cv::Mat luma;
  cv::cvtColor(bgr.rowRange(0, bgr.rows - 240), luma, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(cv::countNonZero(luma.colRange(316, 320) > 100), 0);
  EXPECT_GT(cv::countNonZero(luma.colRange(250, 316) > 150), 0);
}

TEST(OverlayVideo, TwoRunsWriteTheSameBytes) {
  const auto outline = outlined_box(20, 20, 100, 100, kOrange);
  EXPECT_EQ(read_file(video_of(160, 120, 77, {outline}, "same")),
            read_file(video_of(160, 120, 77, {outline}, "same")));
}

}  // namespace
}  // namespace apriltrack
