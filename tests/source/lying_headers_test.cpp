// Pictures whose headers claim what is not there: written out byte by byte, as the formats' documents have
// them.

#include <gmock/gmock.h>

#include <climits>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/source/image_file.h"
#include "image_values.h"
#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
using ::testing::HasSubstr;

std::string little(std::int64_t value, std::size_t size) {
  std::string bytes;
  for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i));
  return bytes;
}

/// A Windows bitmap of 8 bits, without its pixels.
std::string bitmap(std::int64_t width, std::int64_t height) {
  const std::string header = little(40, 4) + little(width, 4) + little(height, 4) + little(1, 2) +
                             little(8, 2) + std::string(24, '\0');
  return "BM" + little(static_cast<std::int64_t>(14 + header.size()), 4) + little(0, 4) + little(54, 4) +
         header;
}

/// Little-endian, with width and height alone.
std::string tiff(std::int64_t width, std::int64_t height) {
  const auto entry = [](std::int64_t tag, std::int64_t value) {
    return little(tag, 2) + little(4, 2) + little(1, 4) + little(value, 4);
  };
  return std::string("II*\0", 4) + little(8, 4) + little(2, 2) + entry(256, width) + entry(257, height) +
         little(0, 4);
}

std::string told_of(const std::string& bytes) {
  ::testing::internal::CaptureStderr();
  std::string told = "nothing was thrown";
  try {
    decode_image(bytes, "x");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    told = error.what();
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "a library talks";
  return told;
}

TEST(LyingHeader, OfABitmapIsToldByItsNumbers) {
  EXPECT_THAT(told_of(bitmap(-640, 480)), HasSubstr("claims -640 x 480 pixels"));
  EXPECT_THAT(told_of(bitmap(INT_MIN, 1)), HasSubstr("claims -2147483648 x 1 pixels"));
  EXPECT_THAT(told_of(bitmap(640, INT_MIN)), HasSubstr("claims 640 x 2147483648 pixels; at most 268435456"));
  EXPECT_THAT(told_of(bitmap(0, 0)), HasSubstr("claims 0 x 0 pixels: a picture has one and more"));
  EXPECT_THAT(told_of(bitmap(640, 0)), HasSubstr("claims 640 x 0 pixels"));
  EXPECT_THAT(told_of(bitmap(65535, 65535)), HasSubstr("claims 65535 x 65535 pixels"));
  EXPECT_THAT(told_of(bitmap(64, 48)),
              HasSubstr("the palette or the pixels of this bitmap are not all there"));
}

TEST(LyingHeader, OfATiffIsToldByItsNumbers) {
  EXPECT_THAT(told_of(tiff(1 << 20, 1 << 20)), HasSubstr("claims 1048576 x 1048576 pixels"));
  EXPECT_THAT(told_of(tiff(0xFFFFFFFF, 0xFFFFFFFF)), HasSubstr("claims 4294967295 x 4294967295 pixels"));
  EXPECT_THAT(told_of(tiff(0, 9)), HasSubstr("claims 0 x 9 pixels"));
  EXPECT_THAT(told_of(tiff(64, 48)), HasSubstr("is damaged"));
  EXPECT_THAT(told_of(std::string("MM\0*", 4) + "\xff\xff\xff\xff"),
              HasSubstr("a TIFF without width and height"));
}

TEST(LyingHeader, OfAPnmIsToldByItsNumbers) {
  EXPECT_THAT(told_of("P5 65535 65535 255\nab"), HasSubstr("claims 65535 x 65535 pixels"));
  EXPECT_THAT(told_of("P2 0 0 255\n"), HasSubstr("claims 0 x 0 pixels"));
  EXPECT_THAT(told_of("P6 9999999999 9999999999 255\n"), HasSubstr("claims 9999999999 x 9999999999 pixels"));
}

TEST(LyingHeader, OfAWebpIsAnError) {
  // The canvas of an extended file is 24 bits a side, less one (WebP container specification).
  const std::string canvas("\xff\xff\xff\xff\xff\xff", 6);
  const std::string file = "WEBPVP8X" + little(10, 4) + std::string(4, '\0') + canvas;
  EXPECT_THAT(told_of("RIFF" + little(static_cast<std::int64_t>(file.size()), 4) + file),
              HasSubstr("not an image that can be decoded"));
}

TEST(LyingHeader, OfTheOldBitmapHasTwoBytesASide) {
  // OS/2 1.x: 12 bytes of header, a palette of three bytes a colour, and rows from below, of 4 bytes each.
  const std::string header = little(12, 4) + little(3, 2) + little(2, 2) + little(1, 2) + little(8, 2);
  std::string palette;
  for (int grey = 0; grey < 256; ++grey) palette += std::string(3, static_cast<char>(grey));
  const std::string rows("\x04\x05\x06\x00\x01\x02\x03\x00", 8);
  const std::string bytes =
      "BM" + little(14 + 12 + 768 + 8, 4) + little(0, 4) + little(14 + 12 + 768, 4) + header + palette + rows;
  const cv::Mat pixels = decode_image(bytes, "old.bmp").pixels;
  ASSERT_EQ(pixels.size(), cv::Size(3, 2));
  EXPECT_EQ(pixels.at<std::uint8_t>(0, 0), 1);
  EXPECT_EQ(pixels.at<std::uint8_t>(1, 2), 6);
}

TEST(OnePixel, IsReadInEveryFormat) {
  for (const std::string ending : {".png", ".jpg", ".bmp", ".tiff", ".webp", ".pgm"}) {
    std::vector<unsigned char> bytes;
    ASSERT_TRUE(cv::imencode(ending, cv::Mat(1, 1, CV_8UC1, cv::Scalar(100)), bytes)) << ending;
    const cv::Mat pixels =
        decode_image({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, ending).pixels;
    ASSERT_EQ(pixels.size(), cv::Size(1, 1)) << ending;
    EXPECT_NEAR(pixels.at<std::uint8_t>(0, 0), 100, 2) << ending;  // lossy ones
  }
}

/// OpenCV gave these to its decoder of medical pictures, whose assertions ended the process: found by
/// fuzzing.
TEST(OtherKinds, NeverReachDecodersThatNoCameraNeeds) {
  const auto medical = [](const std::string& start) {
    return start + std::string(128 - start.size(), '\0') + "DICM\2";
  };
  const std::string other =
      "is not an image that can be decoded: PNG, JPEG, BMP, TIFF, WebP, PGM and PPM are";
  EXPECT_THAT(told_of(medical("P517 9\n65535\n")), HasSubstr(other));
  EXPECT_THAT(told_of(medical("")), HasSubstr(other));
  EXPECT_THAT(told_of(medical("RIFF\x90\1\1\1WEBPVP8 ")), HasSubstr(other));
  EXPECT_THAT(told_of(std::string("\0\0\0\x0cjP  \r\n\x87\n", 12)), HasSubstr(other)) << "JPEG 2000";
  EXPECT_THAT(told_of("#?RADIANCE\n"), HasSubstr(other));
  EXPECT_THAT(told_of("v/1\1\2"), HasSubstr(other)) << "OpenEXR";
}

TEST(PngPicture, WithAnOddColourProfileIsReadSilently) {
  std::vector<unsigned char> encoded;
  cv::imencode(".png", cv::Mat(3, 5, CV_8UC1, cv::Scalar(77)), encoded);
  const std::string bytes(encoded.begin(), encoded.end());
  // Behind IHDR: a profile that is none, and whose sum is wrong.
  const std::string profile = std::string("\0\0\0\4iCCPjunk", 12) + "none";
  ::testing::internal::CaptureStderr();
  const cv::Mat pixels = decode_image(bytes.substr(0, 33) + profile + bytes.substr(33), "odd.png").pixels;
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(cv::countNonZero(pixels == 77), 15);
}

TEST(PngPicture, ThatIsDamagedTellsWhereAndSilently) {
  std::vector<unsigned char> encoded;
  cv::imencode(".png", cv::Mat(30, 50, CV_8UC1, cv::Scalar(77)), encoded);
  for (std::size_t at = 16; at + 12 < encoded.size(); ++at) {
    std::string bytes(encoded.begin(), encoded.end());
    bytes[at] = static_cast<char>(bytes[at] ^ 0x5A);
    EXPECT_THAT(told_of(bytes), HasSubstr("x: ")) << at;
  }
}

}  // namespace
}  // namespace apriltrack::test
