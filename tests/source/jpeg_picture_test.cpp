// Grey pictures of JPEG files: the same as OpenCV's decoder gives, and what that one keeps to itself.

#include "jpeg_picture.h"

#include <gmock/gmock.h>

// In this order: libjpeg's header needs FILE and size_t.
// clang-format off
#include <cstddef>
#include <cstdio>
#include <jpeglib.h>
// clang-format on

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "apriltrack/source/image_file.h"
#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

/// Smooth colours with an edge; neither side a multiple of a block's 8 or 16 pixels.
cv::Mat colourful(int width, int height) {
  cv::Mat picture(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture.at<cv::Vec3b>(y, x) = {static_cast<std::uint8_t>(x),
                                     static_cast<std::uint8_t>(x > y ? 200 : 30),
                                     static_cast<std::uint8_t>(2 * y)};
  return picture;
}

std::string jpeg_of(const cv::Mat& picture, const std::vector<int>& options = {}) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", picture, bytes, options);
  return {bytes.begin(), bytes.end()};
}

cv::Mat by_opencv(const std::string& bytes) {
  return cv::imdecode(std::vector<unsigned char>(bytes.begin(), bytes.end()), cv::IMREAD_GRAYSCALE);
}

bool are_same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_L1) == 0.0;
}

TEST(JpegPicture, IsTheOneThatOpenCvDecodes) {
  int num_checked = 0;
  for (const auto& options :
       {std::vector<int>{}, std::vector<int>{cv::IMWRITE_JPEG_PROGRESSIVE, 1},
        std::vector<int>{cv::IMWRITE_JPEG_RST_INTERVAL, 2}, std::vector<int>{cv::IMWRITE_JPEG_QUALITY, 40}}) {
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(61, 47), cv::Size(128, 64), cv::Size(3, 250)}) {
      cv::Mat grey;
      cv::cvtColor(colourful(size.width, size.height), grey, cv::COLOR_BGR2GRAY);
      for (const cv::Mat& picture : {colourful(size.width, size.height), grey}) {
        const std::string bytes = jpeg_of(picture, options);
        const JpegPicture decoded = decode_jpeg(bytes);
        EXPECT_EQ(decoded.damage, "");
        EXPECT_TRUE(are_same(decoded.pixels, by_opencv(bytes))) << size << ", " << picture.channels();
        ++num_checked;
      }
    }
  }
  EXPECT_EQ(num_checked, 32);
}

/// `bytes` with an EXIF block that tells the orientation, in either byte order.
std::string with_orientation(const std::string& bytes, char orientation, bool is_big_endian) {
  const std::string big{'M', 'M', 0, 42, 0, 0, 0,           8, 0, 1, 1, 18, 0,
                        3,   0,   0, 0,  1, 0, orientation, 0, 0, 0, 0, 0,  0};
  const std::string little{'I', 'I', 42, 0, 8, 0,           0, 0, 1, 0, 18, 1, 3,
                           0,   1,   0,  0, 0, orientation, 0, 0, 0, 0, 0,  0, 0};
  const std::string app1 =
      std::string{'\xff', '\xe1', 0, 34, 'E', 'x', 'i', 'f', 0, 0} + (is_big_endian ? big : little);
  return bytes.substr(0, 2) + app1 + bytes.substr(2);
}

TEST(JpegPicture, IsTurnedUprightAsOpenCvTurnsIt) {
  const std::string bytes = jpeg_of(colourful(61, 47));
  int num_differing = 0;
  for (char orientation = 0; orientation <= 9; ++orientation) {  // 1 to 8 have a meaning
    for (const bool is_big_endian : {true, false}) {
      const std::string turned = with_orientation(bytes, orientation, is_big_endian);
      const cv::Mat pixels = decode_jpeg(turned).pixels;
      EXPECT_TRUE(are_same(pixels, by_opencv(turned))) << int{orientation};
      num_differing += !are_same(pixels, by_opencv(bytes));
    }
  }
  EXPECT_EQ(num_differing, 2 * 7);
}

TEST(JpegPicture, OfDamagedDataIsRefusedWithTheFilesNameAndSilently) {
  const std::string whole = jpeg_of(colourful(250, 180));
  const auto path = temporary_folder() / "hurt.jpg";
  std::mt19937 random(31);
  int num_refused = 0;
  constexpr int kFiles = 100;
  ::testing::internal::CaptureStderr();
  for (int i = 0; i < kFiles; ++i) {
    std::string hurt = whole;
    for (std::size_t k = 0; k < 400; ++k) hurt[hurt.size() / 2 - 200 + k] = static_cast<char>(random());
    write_text(path, hurt);
    try {
      read_image(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kIo);
      EXPECT_THAT(error.what(), ::testing::StartsWith(path.string() + ": "));
      ++num_refused;
    }
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  // Some random bytes are a picture, too: JPEG has no sums. 99 % were told where 400 of 40,000 bytes were
  // hurt.
  EXPECT_GE(num_refused, 95);
}

TEST(JpegPicture, WithAStrayByteBeforeItsEndIsTaken) {
  const std::string whole = jpeg_of(colourful(61, 47));
  const std::string stray = whole.substr(0, whole.size() - 2) + "\x12\x34" + whole.substr(whole.size() - 2);
  ::testing::internal::CaptureStderr();
  const JpegPicture picture = decode_jpeg(stray);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(picture.damage, "");
  EXPECT_TRUE(are_same(picture.pixels, by_opencv(whole)));
}

/// A progressive grey picture whose 63 frequencies come one by one, each in `num_bits` scans.
std::string many_scans(int num_bits) {
  std::vector<jpeg_scan_info> scans = {{1, {0, 0, 0, 0}, 0, 0, 0, 0}};
  for (int frequency = 1; frequency < 64; ++frequency)
    for (int bit = num_bits; bit-- > 0;)
      scans.push_back({1, {0, 0, 0, 0}, frequency, frequency, bit + 1 == num_bits ? 0 : bit + 1, bit});
  jpeg_compress_struct codec{};
  jpeg_error_mgr errors{};
  codec.err = jpeg_std_error(&errors);
  jpeg_create_compress(&codec);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&codec, &bytes, &size);
  codec.image_width = codec.image_height = 16;
  codec.input_components = 1;
  codec.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&codec);
  codec.scan_info = scans.data();
  codec.num_scans = static_cast<int>(scans.size());
  jpeg_start_compress(&codec, TRUE);
  for (int y = 0; y < 16; ++y) {
    std::vector<unsigned char> row(16, static_cast<unsigned char>(16 * y));
    unsigned char* pixels = row.data();
    jpeg_write_scanlines(&codec, &pixels, 1);
  }
  jpeg_finish_compress(&codec);
  jpeg_destroy_compress(&codec);
  const std::string file(reinterpret_cast<const char*>(bytes), size);
  std::free(bytes);
  return file;
}

/// Each scan passes over the whole picture, which may be large, and takes but a few bytes of the file.
TEST(JpegPicture, OfHundredsOfScansIsRefused) {
  EXPECT_EQ(decode_jpeg(many_scans(2)).pixels.size(), cv::Size(16, 16)) << "127 scans";
  EXPECT_THAT(decode_jpeg(many_scans(4)).damage, ::testing::HasSubstr("scan")) << "253 scans";
}

TEST(JpegPicture, OfNoPictureTellsLibjpegsWords) {
  EXPECT_THAT(decode_jpeg("\xff\xd8 no picture").damage, ::testing::HasSubstr("JPEG"));
  EXPECT_NE(decode_jpeg("").damage, "");
}

}  // namespace
}  // namespace apriltrack::test
