#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "apriltrack/source/image_file.h"
#include "bag_pictures.h"
#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

// Encodings. All pictures are 6 x 4 of one colour (red 200, green 100, blue 50), which is 124.2 of Rec. 601.

constexpr int kRed = 200, kGreen = 100, kBlue = 50;
constexpr double kGray = 0.299 * kRed + 0.587 * kGreen + 0.114 * kBlue;

std::string bytes_of(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes += static_cast<char>(value);
  return bytes;
}

struct EncodingCase {
  std::string name;
  ImageFields fields;
  double expected = kGray;
};

void PrintTo(const EncodingCase& one, std::ostream* out) {
  *out << one.name;
}

std::vector<EncodingCase> encoding_cases() {
  const auto two = [](int value) { return bytes_of({value & 255, value >> 8}); };
  std::vector<EncodingCase> cases = {
      {"mono8", picture_of("mono8", bytes_of({77})), 77},
      {"8UC1", picture_of("8UC1", bytes_of({78})), 78},
      {"rgb8", picture_of("rgb8", bytes_of({kRed, kGreen, kBlue}))},
      {"bgr8", picture_of("bgr8", bytes_of({kBlue, kGreen, kRed}))},
      {"8UC3", picture_of("8UC3", bytes_of({kBlue, kGreen, kRed}))},
      {"rgba8", picture_of("rgba8", bytes_of({kRed, kGreen, kBlue, 9}))},
      {"bgra8", picture_of("bgra8", bytes_of({kBlue, kGreen, kRed, 9}))},
      {"bayer_rggb8", picture_of("bayer_rggb8", bytes_of({kRed, kGreen}), bytes_of({kGreen, kBlue}))},
      {"bayer_bggr8", picture_of("bayer_bggr8", bytes_of({kBlue, kGreen}), bytes_of({kGreen, kRed}))},
      {"bayer_gbrg8", picture_of("bayer_gbrg8", bytes_of({kGreen, kBlue}), bytes_of({kRed, kGreen}))},
      {"bayer_grbg8", picture_of("bayer_grbg8", bytes_of({kGreen, kRed}), bytes_of({kBlue, kGreen}))},
      {"yuv422", picture_of("yuv422", bytes_of({90, 61, 30, 61}), bytes_of({90, 61, 30, 61})), 61},
      {"yuv422_yuy2", picture_of("yuv422_yuy2", bytes_of({62, 90, 62, 30}), bytes_of({62, 90, 62, 30})), 62},
  };
  // Numbers that use all 16 bits are divided by 257.
  for (const bool is_big : {false, true}) {
    std::string pixel = two(256 * 91 + 7);  // its two bytes differ
    if (is_big) std::ranges::reverse(pixel);
    for (const char* name : {"mono16", "16UC1"}) {
      cases.push_back({std::string(name) + (is_big ? "_big_endian" : ""), picture_of(name, pixel),
                       (256 * 91 + 7) / 257.0});
      cases.back().fields.is_big_endian = is_big;
    }
  }
  cases.push_back({"bayer_rggb16", picture_of("bayer_rggb16", two(257 * kRed) + two(257 * kGreen),
                                              two(257 * kGreen) + two(257 * kBlue))});
  ImageFields nv12 = picture_of("nv12", bytes_of({63}));
  nv12.data += std::string(static_cast<std::size_t>(nv12.step * kHigh / 2), '\x05');
  cases.push_back({"nv12", nv12, 63});
  return cases;
}

class EveryEncoding : public testing::TestWithParam<EncodingCase> {};

INSTANTIATE_TEST_SUITE_P(Encodings, EveryEncoding, testing::ValuesIn(encoding_cases()),
                         [](const auto& one) { return one.param.name; });

TEST_P(EveryEncoding, GivesTheGreyOfItsColour) {
  for (const Wire wire : {Wire::kRos1, Wire::kCdr, Wire::kCdrBigEndian}) {
    const fs::path bag = bag_of({image_message(wire, GetParam().fields)}, "sensor_msgs/Image", wire);
    const std::vector<SourceFrame> frames = read_all(bag.string(), {.bits = 16});
    ASSERT_EQ(frames.size(), 1u);
    ASSERT_EQ(frames[0].error, "");
    ASSERT_EQ(frames[0].pixels.width(), kWide);
    ASSERT_EQ(frames[0].pixels.height(), kHigh);
    for (int y = 0; y < kHigh; ++y)
      for (int x = 0; x < kWide; ++x)
        EXPECT_NEAR(frames[0].pixels(x, y), GetParam().expected, 0.75) << x << " " << y;
  }
}

/// Exactly as of a file with the same pixels, for a bag is to give the same trajectory.
TEST(BagSource, GivesColoursTheGreyOfAPngFile) {
  cv::Mat picture(64, 64, CV_8UC3);
  cv::randu(picture, 0, 256);
  const fs::path folder = temporary_folder();
  cv::imwrite((folder / "1000000000.png").string(), picture);
  const GrayImage of_file = read_image(folder / "1000000000.png");
  const auto size = static_cast<std::size_t>(picture.total() * picture.elemSize());
  const fs::path bag = bag_of({image_message(
      Wire::kCdr,
      {kSecond, 64, 64, "bgr8", false, 3 * 64, {reinterpret_cast<const char*>(picture.data), size}})});
  EXPECT_THAT(read_all(bag.string()).at(0).pixels, SamePixels(of_file));
}

TEST(BagSource, ScalesSixteenBitsAsAFolderOfFiles) {
  const fs::path folder = temporary_folder() / "pictures";
  fs::create_directories(folder);
  std::vector<std::string> messages;
  for (int k = 0; k < 12; ++k) {
    cv::Mat picture(32, 32, CV_16UC1);
    cv::randu(picture, 0, 200 + 300 * k);  // 12 bits in the last one only
    cv::imwrite((folder / (std::to_string(kSecond * (k + 1)) + ".png")).string(), picture);
    const auto size = static_cast<std::size_t>(picture.total() * picture.elemSize());
    messages.push_back(image_message(Wire::kCdr, {kSecond * (k + 1),
                                                  32,
                                                  32,
                                                  "mono16",
                                                  false,
                                                  2 * 32,
                                                  {reinterpret_cast<const char*>(picture.data), size}}));
  }
  const std::vector<SourceFrame> of_files = read_all(folder.string());
  const fs::path bag = temporary_folder() / "any.mcap";
  std::vector<TestMessage> all;
  for (const std::string& message : messages)
    all.push_back(
        {"/camera/image", "sensor_msgs/Image", kSecond * static_cast<std::int64_t>(all.size() + 1), message});
  write_mcap(bag, Wire::kCdr, all);
  const auto source = open_source(bag.string());
  for (const SourceFrame& expected : of_files) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->timestamp, expected.timestamp);
    EXPECT_THAT(frame->pixels, SamePixels(expected.pixels));
  }
  EXPECT_EQ(source->value_range(), (ValueRange{0, 4095}));
}

TEST(BagSource, RefusesOtherEncodingsByName) {
  const fs::path bag = bag_of({image_message(Wire::kCdr, picture_of("32FC1", "abcd"))});
  expect_refused(bag, ErrorKind::kInvalidInput, {"any.mcap", "/camera/image", "'32FC1' is not read"});
}

TEST(BagSource, RefusesPixelsThatDoNotFit) {
  ImageFields fields = picture_of("mono8", "a");
  fields.data.resize(20);
  expect_refused(bag_of({image_message(Wire::kCdr, fields)}), ErrorKind::kInvalidInput,
                 {"20 bytes of pixels"});
  fields = picture_of("rgb8", "abc");
  fields.step = 17;
  expect_refused(bag_of({image_message(Wire::kCdr, fields)}), ErrorKind::kInvalidInput, {"step is 17"});
  fields.width = 1 << 20;
  fields.height = 1 << 20;
  expect_refused(bag_of({image_message(Wire::kCdr, fields)}), ErrorKind::kInvalidInput, {"claims 1048576 x"});
}

/// One bad picture among good ones is a frame that cannot be read, the first one as any other.
TEST(BagSource, GivesABadPictureAsUnreadable) {
  for (std::size_t bad = 0; bad < 3; ++bad) {
    SCOPED_TRACE(bad);
    std::vector<std::string> messages;
    for (std::size_t i = 0; i < 3; ++i) {
      ImageFields fields = picture_of("mono8", "a");
      fields.stamp_ns = static_cast<std::int64_t>(i + 1) * kSecond;
      if (i == bad) fields.data.resize(20);
      messages.push_back(image_message(Wire::kCdr, fields));
    }
    const auto frames = read_all(bag_of(messages).string());
    ASSERT_EQ(frames.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(frames[i].is_readable(), i != bad);
      EXPECT_EQ(frames[i].timestamp.ns, static_cast<std::int64_t>(i + 1) * kSecond);
    }
    EXPECT_THAT(frames[bad].error, HasSubstr("20 bytes of pixels"));
    EXPECT_TRUE(frames[bad].pixels.is_empty());
  }
}

// Packed pictures.

std::string file_bytes(const std::string& ending, const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  cv::imencode(ending, picture, bytes);
  return {bytes.begin(), bytes.end()};
}

TEST(BagSource, ReadsPackedPicturesAsFiles) {
  cv::Mat picture(48, 64, CV_8UC3);
  cv::randu(picture, 0, 256);
  for (const auto& [ending, format] :
       {std::pair<std::string, std::string>{".jpg", "bgr8; jpeg compressed bgr8"},
        {".jpg", "jpeg"},
        {".png", "rgb8; png compressed bgr8"}}) {
    const std::string bytes = file_bytes(ending, picture);
    const fs::path file = temporary_folder() / ("any" + ending);
    write_text(file, bytes);
    const GrayImage of_file = read_image(file);
    for (const Wire wire : {Wire::kRos1, Wire::kCdr}) {
      const fs::path bag = bag_of({compressed_image_message(wire, 5 * kSecond, format, bytes)},
                                  "sensor_msgs/CompressedImage", wire);
      const auto frames = read_all(bag.string());
      ASSERT_EQ(frames.size(), 1u);
      EXPECT_EQ(frames[0].timestamp.ns, 5 * kSecond);
      EXPECT_THAT(frames[0].pixels, SamePixels(of_file)) << format;
    }
  }
}

TEST(BagSource, ReadsPackedMosaicsAsMosaics) {
  cv::Mat mosaic(48, 64, CV_8UC1);
  cv::randu(mosaic, 0, 256);
  const fs::path raw =
      bag_of({image_message(Wire::kCdr, {.stamp_ns = kSecond,
                                         .width = 64,
                                         .height = 48,
                                         .encoding = "bayer_rggb8",
                                         .step = 64,
                                         .data = std::string(mosaic.begin<char>(), mosaic.end<char>())})},
             "sensor_msgs/Image");
  const GrayImage expected = std::move(read_all(raw.string()).at(0).pixels);
  const fs::path packed =
      bag_of({compressed_image_message(Wire::kCdr, kSecond, "bayer_rggb8; png compressed bayer_rggb8",
                                       file_bytes(".png", mosaic))},
             "sensor_msgs/CompressedImage");
  EXPECT_THAT(read_all(packed.string()).at(0).pixels, SamePixels(expected));
}

TEST(BagSource, ReadsPackedPicturesOfSixteenBits) {
  cv::Mat picture(32, 32, CV_16UC1);
  cv::randu(picture, 0, 1024);
  const std::string bytes = file_bytes(".png", picture);
  const fs::path file = temporary_folder() / "any.png";
  write_text(file, bytes);
  const GrayImage of_file = read_image(file);
  const fs::path bag =
      bag_of({compressed_image_message(Wire::kRos1, kSecond, "mono16; png compressed ", bytes)},
             "sensor_msgs/CompressedImage", Wire::kRos1);
  EXPECT_THAT(read_all(bag.string()).at(0).pixels, SamePixels(of_file));
}

TEST(BagSource, RefusesOtherCodecsByName) {
  for (const char* format : {"16UC1; compressedDepth png", "h264", "theora"}) {
    const fs::path bag = bag_of({compressed_image_message(Wire::kCdr, kSecond, format, "any bytes")},
                                "sensor_msgs/CompressedImage");
    expect_refused(bag, ErrorKind::kInvalidInput,
                   {"/camera/image", std::string("'") + format + "' is not read"});
  }
}

}  // namespace
}  // namespace apriltrack::test
