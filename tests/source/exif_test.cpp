// Phones store pictures as the sensor saw them and say in the EXIF block how to turn them.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "apriltrack/io/atomic_file.h"
#include "apriltrack/source/image_file.h"
#include "image_values.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

/// A JPEG file of 48 x 32 pixels, black but for a white left half, with EXIF tag 0x0112 (orientation).
std::string jpeg_with_orientation(char orientation) {
  cv::Mat stored(32, 48, CV_8UC1, cv::Scalar(0));
  stored.colRange(0, 24).setTo(255);
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", stored, bytes);
  // APP1: length 34, "Exif", big-endian TIFF header, one directory of one entry: SHORT, count 1, the value.
  const std::string app1{'\xff', '\xe1', 0, 34, 'E', 'x',         'i', 'f', 0, 0,  'M', 'M',
                         0,      42,     0, 0,  0,   8,           0,   1,   1, 18, 0,   3,
                         0,      0,      0, 1,  0,   orientation, 0,   0,   0, 0,  0,   0};
  std::string file(bytes.begin(), bytes.end());
  return file.substr(0, 2) + app1 + file.substr(2);
}

GrayImage read(char orientation) {
  const auto path = test::temporary_folder() / "phone.jpg";
  write_file_atomically(path, jpeg_with_orientation(orientation));
  return read_image(path);
}

TEST(ExifOrientation, UprightPictureStaysAsItIs) {
  const GrayImage image = read(1);
  ASSERT_EQ(image.width(), 48);
  ASSERT_EQ(image.height(), 32);
  EXPECT_GT(image(8, 16), 200);
  EXPECT_LT(image(40, 16), 50);
}

TEST(ExifOrientation, SixTurnsAQuarterClockwise) {
  // EXIF 2.3, 4.6.4: 6 = row 0 of the file is the picture's right-hand side; its left half comes out on top.
  const GrayImage image = read(6);
  ASSERT_EQ(image.width(), 32);
  ASSERT_EQ(image.height(), 48);
  EXPECT_GT(image(16, 8), 200);
  EXPECT_LT(image(16, 40), 50);
}

/// CameraInfo describes the pixels that the camera sent.
TEST(ExifOrientation, LeavesPicturesOfMessagesAsStored) {
  const cv::Mat pixels = decode_image(jpeg_with_orientation(3), "x", PictureTurn::kAsStored).pixels;
  ASSERT_EQ(pixels.size(), cv::Size(48, 32));
  EXPECT_GT(pixels.at<std::uint8_t>(16, 4), 200);
  EXPECT_LT(pixels.at<std::uint8_t>(16, 44), 50);
}

TEST(ExifOrientation, ThreeTurnsHalfRound) {
  const GrayImage image = read(3);
  ASSERT_EQ(image.width(), 48);
  EXPECT_LT(image(8, 16), 50);
  EXPECT_GT(image(40, 16), 200);
}

}  // namespace
}  // namespace apriltrack
