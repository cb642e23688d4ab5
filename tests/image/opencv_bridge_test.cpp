#include "apriltrack/image/opencv_bridge.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

TEST(OpencvBridge, ViewOfAMatSharesItsPixels) {
  cv::Mat mat(3, 4, CV_8UC1, cv::Scalar(7));
  const GrayView view = view_of(mat);
  EXPECT_EQ(view.data(), mat.data);
  EXPECT_EQ(view.width(), 4);
  EXPECT_EQ(view.height(), 3);
  mat.at<std::uint8_t>(2, 1) = 99;  // OpenCV: row, column
  EXPECT_EQ(view(1, 2), 99);        // ours: x, y
}

TEST(OpencvBridge, ViewOfARegionKeepsTheStrideOfTheWhole) {
  cv::Mat whole(6, 10, CV_8UC1, cv::Scalar(0));
  whole.at<std::uint8_t>(4, 5) = 42;
  const cv::Mat region = whole(cv::Rect(3, 2, 4, 3));
  const GrayView view = view_of(region);
  EXPECT_EQ(view.stride(), 10);
  EXPECT_EQ(view.width(), 4);
  EXPECT_EQ(view(2, 2), 42);
}

TEST(OpencvBridge, MatOfAViewSharesItsPixels) {
  GrayImage image(5, 4, 1);
  cv::Mat writable = mat_of(image.view());
  EXPECT_EQ(writable.data, image.row(0));
  writable.at<std::uint8_t>(3, 2) = 50;
  EXPECT_EQ(image(2, 3), 50);
  const GrayImage& constant = image;
  const cv::Mat readable = mat_of(constant.view());
  EXPECT_EQ(readable.data, image.row(0));
  EXPECT_EQ(readable.cols, 5);
  EXPECT_EQ(readable.rows, 4);
}

TEST(OpencvBridge, RoundTripKeepsARegion) {
  GrayImage image(8, 8, 0);
  image(3, 4) = 11;
  const GrayView part(image.row(2) + 1, 5, 4, 8);
  const GrayView again = view_of(mat_of(part));
  EXPECT_EQ(again.data(), part.data());
  EXPECT_EQ(again.stride(), 8);
  EXPECT_EQ(again(2, 2), 11);
}

TEST(OpencvBridge, RefusesColourAndFloats) {
  EXPECT_THROW(view_of(cv::Mat(2, 2, CV_8UC3)), MisuseError);
  EXPECT_THROW(view_of(cv::Mat(2, 2, CV_32FC1)), MisuseError);
}

}  // namespace
}  // namespace apriltrack
