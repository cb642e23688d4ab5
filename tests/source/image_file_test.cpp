#include "apriltrack/source/image_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "image_integrity.h"
#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kWidth = 61;  // odd, so that padded rows would show
constexpr int kHeight = 47;

/// A smooth picture, as JPEG keeps it to a few grey levels.
cv::Mat smooth_picture() {
  cv::Mat picture(kHeight, kWidth, CV_8UC1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x)
      picture.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(2 * x + 2 * y);
  }
  return picture;
}

std::string encoded(const std::string& ending, const cv::Mat& picture,
                    const std::vector<int>& parameters = {}) {
  std::vector<unsigned char> bytes;
  cv::imencode(ending, picture, bytes, parameters);
  return {bytes.begin(), bytes.end()};
}

void expect_unreadable(const std::filesystem::path& path, const std::vector<std::string>& words) {
  expect_error(ErrorKind::kIo, words, [&] { read_image(path); });
}

TEST(ReadImage, GivesThePixelsOfAPgmByteForByte) {
  const auto path = temporary_folder() / "a.pgm";
  write_pgm(path, test_picture(kWidth, kHeight));
  EXPECT_THAT(read_image(path), SamePixels(test_picture(kWidth, kHeight)));
}

TEST(ReadImage, WeighsColourByRec601AndIgnoresAlpha) {
  // Blue, green, red and a mixture; published weights 0.299 R + 0.587 G + 0.114 B.
  const std::vector<cv::Vec4b> colours = {
      {255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {200, 100, 50, 7}};
  const std::vector<double> expected = {0.114 * 255, 0.587 * 255, 0.299 * 255,
                                        0.114 * 200 + 0.587 * 100 + 0.299 * 50};
  cv::Mat with_alpha(1, 4, CV_8UC4);
  for (int i = 0; i < 4; ++i) with_alpha.at<cv::Vec4b>(0, i) = colours[static_cast<std::size_t>(i)];
  cv::Mat without_alpha(1, 4, CV_8UC3);
  cv::mixChannels(with_alpha, without_alpha, {0, 0, 1, 1, 2, 2});
  const auto folder = temporary_folder();
  write_text(folder / "alpha.png", encoded(".png", with_alpha));
  write_text(folder / "colour.png", encoded(".png", without_alpha));
  for (const char* name : {"alpha.png", "colour.png"}) {
    const GrayImage image = read_image(folder / name);
    ASSERT_EQ(image.width(), 4);
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(image(i, 0), expected[static_cast<std::size_t>(i)], 1.01) << name << " " << i;
  }
}

/// libpng's own conversion cuts fractions off: 0.5 grey levels on average.
TEST(ReadImage, GivesColoursOneGreyWhateverTheFormat) {
  cv::Mat picture(kHeight, kWidth, CV_8UC3);
  cv::randu(picture, 0, 256);
  for (const std::string ending : {".png", ".ppm", ".bmp", ".tiff"}) {
    const auto path = temporary_folder() / ("any" + ending);
    write_text(path, encoded(ending, picture));
    const GrayImage image = read_image(path);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto& bgr = picture.at<cv::Vec3b>(y, x);
        ASSERT_NEAR(image(x, y), 0.299 * bgr[2] + 0.587 * bgr[1] + 0.114 * bgr[0], 0.51) << ending;
      }
    }
  }
}

TEST(ReadImage, ScalesSixteenBitsDown) {
  cv::Mat deep(1, 3, CV_16UC1);
  deep.at<std::uint16_t>(0, 0) = 0;
  deep.at<std::uint16_t>(0, 1) = 0x8000;
  deep.at<std::uint16_t>(0, 2) = 0xFFFF;
  const auto path = temporary_folder() / "deep.png";
  write_text(path, encoded(".png", deep));
  const GrayImage image = read_image(path);
  EXPECT_EQ(image(0, 0), 0);
  EXPECT_EQ(image(1, 0), 128);
  EXPECT_EQ(image(2, 0), 255);
}

/// The PNM formats' definition: a number over the header's largest is the share of white.
TEST(ReadImage, ScalesPnmByTheLargestValueOfItsHeader) {
  const auto path = temporary_folder() / "scaled.pgm";
  int checked = 0;
  for (const char kind : {'2', '3', '5', '6'}) {
    for (const int largest : {1, 100, 254, 255, 256, 1023, 4095, 16383, 65535}) {
      const bool is_colour = kind == '3' || kind == '6';
      const bool is_binary = kind == '5' || kind == '6';
      std::string text = std::string("P") + kind + "\n# a camera's\n9 1\n" + std::to_string(largest) + "\n";
      std::vector<int> values;
      for (int i = 0; i < 9; ++i) values.push_back(i * largest / 8);
      for (const int value : values) {
        for (int channel = 0; channel < (is_colour ? 3 : 1); ++channel) {
          if (!is_binary) {
            text += std::to_string(value) + " ";
            continue;
          }
          if (largest > 255) text += static_cast<char>(value >> 8);
          text += static_cast<char>(value & 0xFF);
        }
      }
      write_text(path, text);
      const GrayImage image = read_image(path);
      ASSERT_EQ(image.width(), 9);
      for (int i = 0; i < 9; ++i) {
        const double expected = 255.0 * values[static_cast<std::size_t>(i)] / largest;
        const bool is_cut = !is_binary && largest < 255;  // OpenCV scales these, and cuts decimals off
        EXPECT_NEAR(image(i, 0), expected, is_cut ? 0.9999 : 0.5001)
            << "P" << kind << " of " << largest << ", pixel " << i;
        ++checked;
      }
    }
  }
  EXPECT_EQ(checked, 4 * 9 * 9);
}

TEST(ReadImage, RefusesAPnmWhoseLargestValueIsNone) {
  const auto folder = temporary_folder();
  write_text(folder / "zero.pgm", "P5\n2 1\n0\nab");
  write_text(folder / "large.pgm", "P2\n2 1\n65536\n0 1\n");
  expect_unreadable(folder / "zero.pgm", {"zero.pgm", "[1, 65535]", "is 0"});
  expect_unreadable(folder / "large.pgm", {"large.pgm", "65536"});
}

TEST(ReadImage, TellsAMissingFileAFolderAndAnEmptyFileApart) {
  const auto folder = temporary_folder();
  write_text(folder / "empty.png", "");
  write_text(folder / "text.png", "these are words, not a picture");
  expect_unreadable(folder / "missing.png", {"missing.png", "No such file"});
  expect_unreadable(folder, {"it is a folder"});
  expect_unreadable(folder / "empty.png", {"empty.png", "0 bytes"});
  expect_unreadable(folder / "text.png", {"text.png", "not an image"});
}

class CutImage : public ::testing::TestWithParam<std::tuple<std::string, std::vector<int>>> {};

TEST_P(CutImage, IsUnreadableWhereverItWasCut) {
  const auto& [ending, parameters] = GetParam();
  const std::string whole = encoded(ending, smooth_picture(), parameters);
  const auto path = temporary_folder() / ("cut" + ending);
  write_text(path, whole);
  EXPECT_EQ(read_image(path).width(), kWidth);
  int num_checked = 0;
  for (std::size_t length = 1; length + 1 < whole.size(); length += 1 + whole.size() / 97) {
    write_text(path, whole.substr(0, length));
    EXPECT_THROW(read_image(path), Error) << length << " of " << whole.size() << " bytes";
    ++num_checked;
  }
  EXPECT_GT(num_checked, 50);
}

TEST_P(CutImage, WithAppendedBytesIsStillRead) {
  const auto& [ending, parameters] = GetParam();
  const auto path = temporary_folder() / ("long" + ending);
  write_text(path, encoded(ending, smooth_picture(), parameters) + std::string(100, '\0'));
  EXPECT_EQ(read_image(path).height(), kHeight);
}

INSTANTIATE_TEST_SUITE_P(
    Formats, CutImage,
    ::testing::Values(std::tuple(".jpg", std::vector<int>{}),
                      std::tuple(".jpg", std::vector<int>{cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
                      std::tuple(".jpg", std::vector<int>{cv::IMWRITE_JPEG_RST_INTERVAL, 2}),
                      std::tuple(".png", std::vector<int>{}), std::tuple(".pgm", std::vector<int>{}),
                      std::tuple(".bmp", std::vector<int>{})));

TEST(ReadImage, RefusesAJpegThatBreaksOffInTheMiddle) {
  std::string bytes = encoded(".jpg", smooth_picture());
  // A marker of another segment amid the coded picture: decoders stop there and fill up with grey.
  bytes[bytes.size() - 40] = '\xff';
  bytes[bytes.size() - 39] = '\xc4';
  const auto path = temporary_folder() / "broken.jpg";
  write_text(path, bytes);
  expect_unreadable(path, {"broken.jpg", "damaged"});
}

TEST(ReadImage, RefusesAPngWhosePixelsWereChangedOnDisk) {
  std::string bytes = encoded(".png", smooth_picture());
  const std::size_t at = bytes.find("IDAT");
  ASSERT_NE(at, std::string::npos);
  int num_checked = 0;
  for (std::size_t offset = at + 8; offset + 24 < bytes.size(); offset += 11, ++num_checked) {
    std::string damaged = bytes;
    damaged[offset] = static_cast<char>(damaged[offset] ^ 0x5A);
    const auto path = temporary_folder() / "damaged.png";
    write_text(path, damaged);
    EXPECT_THROW(read_image(path), Error) << "byte " << offset << " of " << bytes.size();
  }
  EXPECT_GT(num_checked, 3);
}

TEST(ReadImage, RefusesFilesThatClaimMorePixelsThanAnyCamera) {
  const auto folder = temporary_folder();
  std::string png = encoded(".png", smooth_picture());
  png.replace(16, 8, std::string("\x7f\xff\xff\xff\x7f\xff\xff\xff", 8));
  write_text(folder / "bomb.png", png);
  std::string jpeg = encoded(".jpg", smooth_picture());
  const std::size_t frame = jpeg.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  jpeg.replace(frame + 5, 4, "\xff\xff\xff\xff");
  write_text(folder / "bomb.jpg", jpeg);
  expect_unreadable(folder / "bomb.png", {"bomb.png", "2147483647 x 2147483647"});
  expect_unreadable(folder / "bomb.jpg", {"bomb.jpg", "65535 x 65535"});
}

TEST(WriteImage, KeepsEveryPixelInLosslessFormats) {
  const GrayImage image = test_picture(kWidth, kHeight);
  const auto folder = temporary_folder();
  for (const char* name : {"a.png", "a.pgm", "A.PNG"}) {
    write_image(folder / name, image.view());
    EXPECT_THAT(read_image(folder / name), SamePixels(image)) << name;
  }
  // Judged by other eyes than read_image's.
  const std::string pgm = read_bytes(folder / "a.pgm");
  EXPECT_EQ(pgm.substr(pgm.size() - kWidth * kHeight),
            std::string(reinterpret_cast<const char*>(image.row(0)), kWidth * kHeight));
}

TEST(WriteImage, WritesAViewWithPaddedRows) {
  const GrayImage image = test_picture(kWidth, kHeight);
  const GrayView part(image.view().row(3) + 5, 20, 10, image.view().stride());
  const auto path = temporary_folder() / "part.png";
  write_image(path, part);
  const GrayImage back = read_image(path);
  ASSERT_EQ(back.width(), 20);
  EXPECT_EQ(back(0, 0), image(5, 3));
  EXPECT_EQ(back(19, 9), image(24, 12));
}

TEST(WriteImage, JpegIsCloseToThePicture) {
  const cv::Mat picture = smooth_picture();
  const auto path = temporary_folder() / "a.jpg";
  write_image(path, GrayView(picture.data, kWidth, kHeight, kWidth));
  const GrayImage back = read_image(path);
  double sum = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) sum += std::pow(back(x, y) - picture.at<std::uint8_t>(y, x), 2);
  }
  EXPECT_LT(std::sqrt(sum / (kWidth * kHeight)), 2.0);  // grey levels; quality 95
}

TEST(WriteImage, SaysWhyItCannotWriteAndLeavesNothingBehind) {
  const auto folder = temporary_folder();
  const GrayImage image = test_picture(4, 4);
  expect_error(ErrorKind::kIo, {"missing/a.png", "No such file"},
               [&] { write_image(folder / "missing" / "a.png", image.view()); });
  expect_error(ErrorKind::kInvalidInput, {"a.xyz", ".png, .jpg or .pgm"},
               [&] { write_image(folder / "a.xyz", image.view()); });
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

}  // namespace
}  // namespace apriltrack::test
