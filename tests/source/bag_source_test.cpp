#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "apriltrack/source/bag_input.h"
#include "apriltrack/source/image_file.h"
#include "bag/bag_writers.h"
#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000'000;

std::string bag_fixture(const std::string& name) {
  return source_path("tests/bag/data/" + name).string();
}

// The files that other projects' writers made (tests/bag/recording.h tells what is in them).

class PicturesOfEveryBag : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Bags, PicturesOfEveryBag,
                         testing::Values("plain.bag", "bz2.bag", "lz4.bag", "plain.mcap", "lz4.mcap",
                                         "zstd.mcap", "ros1_zstd.mcap", "without_chunks.mcap",
                                         "without_index.mcap", "plain.db3", "split", "packed_messages",
                                         "packed_file"));

GrayImage recorded_picture(int k) {
  GrayImage picture(16, 12);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x) picture(x, y) = static_cast<std::uint8_t>(7 * x + 13 * y + 31 * k);
  return picture;
}

TEST_P(PicturesOfEveryBag, HaveTheirPixelsAndTheTimesOfTheirHeaders) {
  const std::vector<SourceFrame> frames = read_all(bag_fixture(GetParam()));
  ASSERT_EQ(frames.size(), 8u);
  for (int k = 0; k < 8; ++k) {
    const SourceFrame& frame = frames[static_cast<std::size_t>(k)];
    EXPECT_EQ(frame.error, "");
    EXPECT_EQ(frame.timestamp.ns, 1'700'000'000'123'456'789 + k * 100'000'000LL);
    EXPECT_THAT(frame.pixels, SamePixels(recorded_picture(k)));
    EXPECT_THAT(frame.name, HasSubstr("/camera/image_raw message " + std::to_string(k)));
  }
}

TEST_P(PicturesOfEveryBag, AreSkippedAndSampled) {
  const auto source = open_source(bag_fixture(GetParam()), {.skip = 1, .step = 3});
  EXPECT_EQ(source->num_frames(), 3u);
  for (const int k : {1, 4, 7}) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_THAT(frame->pixels, SamePixels(recorded_picture(k)));
  }
  EXPECT_FALSE(source->next());
}

TEST_P(PicturesOfEveryBag, BringTheirCamera) {
  const auto camera = bag_camera(bag_fixture(GetParam()));
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, 16);
  EXPECT_EQ(camera->height, 12);
  EXPECT_EQ(camera->response_origin, ResponseOrigin::kAssumed);
  const Pinhole& pinhole = camera->model.pinhole();
  EXPECT_EQ(std::vector({pinhole.fx, pinhole.fy, pinhole.cx, pinhole.cy}),
            std::vector({20.5, 21.5, 7.25, 5.75}));
  const auto& lens = std::get<RadtanDistortion>(camera->model.distortion());
  EXPECT_EQ(lens.coefficients(), std::vector({-0.25, 0.125, 0.0009765625, -0.001953125, 0.0625}));
}

// Encodings. All pictures are 6 x 4 of one colour (red 200, green 100, blue 50), which is 124.2 of Rec. 601.

constexpr int kWide = 6, kHigh = 4;
constexpr int kRed = 200, kGreen = 100, kBlue = 50;
constexpr double kGray = 0.299 * kRed + 0.587 * kGreen + 0.114 * kBlue;

/// pattern: bytes that a row repeats; of every second row the second one, where there is one.
ImageFields picture_of(const std::string& encoding, const std::string& pattern,
                       const std::string& second = "") {
  ImageFields fields{.stamp_ns = kSecond, .width = kWide, .height = kHigh, .encoding = encoding};
  constexpr int kPadding = 5;
  std::string rows[2];
  const bool is_per_pixel = second.empty();
  for (int x = 0; x < kWide / (is_per_pixel ? 1 : 2); ++x) {
    rows[0] += pattern;
    rows[1] += is_per_pixel ? pattern : second;
  }
  fields.step = static_cast<int>(rows[0].size()) + kPadding;
  for (int y = 0; y < kHigh; ++y) fields.data += rows[y % 2] + std::string(kPadding, '\x77');
  return fields;
}

std::string bytes_of(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes += static_cast<char>(value);
  return bytes;
}

fs::path bag_of(const std::vector<std::string>& messages, const std::string& type = "sensor_msgs/Image",
                Wire wire = Wire::kCdr) {
  const fs::path path = temporary_folder() / "any.mcap";
  std::vector<TestMessage> all;
  for (const std::string& message : messages)
    all.push_back({"/camera/image", type, kSecond * static_cast<std::int64_t>(all.size() + 1), message});
  write_mcap(path, wire, all);
  return path;
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

/// One bad picture among good ones is a frame that cannot be read.
TEST(BagSource, GivesABadPictureAsUnreadable) {
  ImageFields cut = picture_of("mono8", "a");
  cut.stamp_ns = 2 * kSecond;
  cut.data.resize(20);
  ImageFields last = picture_of("mono8", "b");
  last.stamp_ns = 3 * kSecond;
  const auto frames = read_all(bag_of({image_message(Wire::kCdr, picture_of("mono8", "a")),
                                       image_message(Wire::kCdr, cut), image_message(Wire::kCdr, last)})
                                   .string());
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_TRUE(frames[0].is_readable());
  EXPECT_THAT(frames[1].error, HasSubstr("20 bytes of pixels"));
  EXPECT_TRUE(frames[1].pixels.is_empty());
  EXPECT_EQ(frames[1].timestamp.ns, 2 * kSecond);
  EXPECT_TRUE(frames[2].is_readable());
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

// Topics.

TestMessage small_picture(const std::string& topic, std::int64_t stamp_ns, char value = 'a') {
  ImageFields fields = picture_of("mono8", std::string(1, value));
  fields.stamp_ns = stamp_ns;
  return {topic, "sensor_msgs/Image", stamp_ns + 1000, image_message(Wire::kCdr, fields)};
}

TEST(BagSource, AsksWhichOfSeveralTopics) {
  const fs::path bag = temporary_folder() / "two.db3";
  write_db3(bag,
            {small_picture("/left/image_raw", kSecond, 'l'), small_picture("/right/image_raw", kSecond, 'r'),
             small_picture("/right/image_raw", 2 * kSecond, 'r')});
  expect_refused(bag, ErrorKind::kInvalidInput,
                 {"--topic", "two.db3", "/left/image_raw (sensor_msgs/msg/Image, 1 message)",
                  "/right/image_raw (sensor_msgs/msg/Image, 2 messages)"});
  const auto frames = read_all(bag.string(), {.topic = "/right/image_raw"});
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].pixels(3, 3), 'r');
}

TEST(BagSource, RefusesTopicsThatAreNotThereOrHaveNoPictures) {
  const fs::path bag = temporary_folder() / "one.mcap";
  write_mcap(bag, Wire::kCdr,
             {small_picture("/image", kSecond), {"/tf", "tf2_msgs/TFMessage", kSecond, "any"}});
  expect_refused(bag, ErrorKind::kInvalidInput, {"--topic", "no topic '/other'", "/image", "/tf"},
                 {.topic = "/other"});
  expect_refused(bag, ErrorKind::kInvalidInput, {"--topic", "'/tf'", "tf2_msgs/msg/TFMessage", "/image"},
                 {.topic = "/tf"});
}

TEST(BagSource, ListsTheTopicsOfABagWithoutPictures) {
  const fs::path bag = temporary_folder() / "none.mcap";
  write_mcap(bag, Wire::kCdr,
             {{"/tf", "tf2_msgs/TFMessage", kSecond, "any"},
              {"/video", "ffmpeg_image_transport_msgs/FFMPEGPacket", kSecond, "any"}});
  expect_refused(bag, ErrorKind::kInvalidInput,
                 {"no topic with pictures", "/tf (tf2_msgs/msg/TFMessage, 1 message)", "video in messages"});
}

TEST(BagSource, TakesATopicOfBagsOnly) {
  const fs::path folder = temporary_folder() / "pictures";
  write_frames(folder, {"1000000000.pgm"});
  expect_refused(folder, ErrorKind::kInvalidInput, {"--topic", "is of a bag"}, {.topic = "/image"});
}

/// A bag that lies beside a recording's pictures does not take its place.
TEST(BagSource, LeavesOtherRecordingsAsTheyAre) {
  const fs::path folder = temporary_folder();
  const std::string bag = read_bytes(bag_fixture("zstd.mcap"));
  for (const char* name : {"sequence", "images", "bag"}) write_text(folder / name / "any.mcap", bag);
  write_frames(folder / "sequence/frames", {"1000000000.pgm"});
  write_frames(folder / "images", {"1000000000.pgm", "2000000000.pgm"});
  EXPECT_EQ(read_all((folder / "sequence").string()).size(), 1u);
  EXPECT_EQ(read_all((folder / "images").string()).size(), 2u);
  EXPECT_EQ(read_all((folder / "bag").string()).size(), 8u);
  EXPECT_FALSE(is_bag_input((folder / "sequence").string()));
  EXPECT_FALSE(is_bag_input((folder / "images").string()));
  EXPECT_TRUE(is_bag_input((folder / "bag").string()));
}

TEST(BagSource, SaysThatAStubIsEmpty) {
  const fs::path folder = temporary_folder();
  write_text(folder / "stub.bag", "#ROSBAG V2.0\n" + std::string(2000, '\0'));
  expect_refused(folder / "stub.bag", ErrorKind::kIo, {"stub.bag", "bag without a topic"});
  write_text(folder / "stub.mcap", std::string("\x89MCAP0\r\n", 8) + std::string(2000, '\0'));
  expect_refused(folder / "stub.mcap", ErrorKind::kIo, {"stub.mcap", "bag without a topic"});
}

// Times.

TEST(BagSource, AsksForARateWhereHeadersHaveNoTime) {
  const fs::path bag = temporary_folder() / "any.bag";
  std::vector<TestMessage> messages;
  for (int k = 0; k < 3; ++k) {
    messages.push_back({"/image", "sensor_msgs/Image", kSecond * (k + 1),
                        image_message(Wire::kRos1, picture_of("mono8", "a"))});
    ImageFields fields = picture_of("mono8", "a");
    fields.stamp_ns = 0;
    messages.back().bytes = image_message(Wire::kRos1, fields);
  }
  write_ros1_bag(bag, messages);
  expect_refused(bag, ErrorKind::kInvalidInput, {"/image", "header.stamp is 0", "--rate HZ"});
  EXPECT_EQ(times_of(read_all(bag.string(), {.rate_hz = 4.0})),
            (std::vector<std::int64_t>{0, 250'000'000, 500'000'000}));
}

TEST(BagSource, GivesPicturesWhoseTimesGoBackAsUnreadable) {
  const fs::path bag = temporary_folder() / "any.mcap";
  std::vector<TestMessage> messages;
  for (const std::int64_t stamp : {10, 12, 11, 12, 13}) {
    messages.push_back(small_picture("/image", stamp * kSecond));
    messages.back().log_time_ns = kSecond * static_cast<std::int64_t>(20 + messages.size());
  }
  write_mcap(bag, Wire::kCdr, messages);
  const auto frames = read_all(bag.string());
  ASSERT_EQ(frames.size(), 5u);
  EXPECT_TRUE(frames[0].is_readable() && frames[1].is_readable() && frames[4].is_readable());
  for (const std::size_t i : {2u, 3u}) EXPECT_THAT(frames[i].error, HasSubstr("is not later than"));
  EXPECT_TRUE(frames[2].pixels.is_empty());
}

TEST(StampIs, MovesTimesToTheMiddleOfTheExposure) {
  const fs::path bag = temporary_folder() / "any.mcap";
  write_mcap(bag, Wire::kCdr, {small_picture("/image", kSecond), small_picture("/image", 2 * kSecond)});
  const auto times = [&](StampIs stamp_is) {
    return times_of(read_all(bag.string(), {.stamp_is = stamp_is, .exposure_s = 0.016}));
  };
  EXPECT_EQ(times(StampIs::kStart), (std::vector<std::int64_t>{1'008'000'000, 2'008'000'000}));
  EXPECT_EQ(times(StampIs::kMiddle), (std::vector<std::int64_t>{kSecond, 2 * kSecond}));
  EXPECT_EQ(times(StampIs::kEnd), (std::vector<std::int64_t>{992'000'000, 1'992'000'000}));
}

TEST(StampIs, NeedsAnExposure) {
  const fs::path bag = temporary_folder() / "any.mcap";
  write_mcap(bag, Wire::kCdr, {small_picture("/image", kSecond)});
  expect_refused(bag, ErrorKind::kInvalidInput, {"--stamp-is", "'end'", "exposure_time"},
                 {.stamp_is = StampIs::kEnd});
}

TEST(StampIs, TakesAFramesOwnExposureFirst) {
  const fs::path folder = temporary_folder() / "sequence";
  write_frames(folder / "frames", {"1000000000.pgm", "2000000000.pgm"});
  write_text(folder / "frames.csv", "timestamp_ns,exposure_s\n1000000000,0.002\n2000000000,0.004\n");
  EXPECT_EQ(times_of(read_all(folder.string(), {.stamp_is = StampIs::kStart})),
            (std::vector<std::int64_t>{1'001'000'000, 2'002'000'000}));
}

// Damage.

TEST(BagSource, TellsOfACutBagOnceAndReadsWhatIsThere) {
  const std::string whole = read_bytes(bag_fixture("zstd.mcap"));
  const fs::path bag = temporary_folder() / "cut.mcap";
  write_text(bag, whole.substr(0, 3000));
  std::vector<std::string> told;
  SourceOptions options;
  options.log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarning) told.emplace_back(text);
  };
  const auto frames = read_all(bag.string(), options);
  EXPECT_EQ(frames.size(), 6u);  // three chunks of two pictures
  for (const SourceFrame& frame : frames) EXPECT_TRUE(frame.is_readable());
  ASSERT_EQ(told.size(), 1u);
  EXPECT_THAT(told[0], AllOf(HasSubstr("cut.mcap"), HasSubstr("cut off or damaged"), HasSubstr("byte")));
}

TEST(BagSource, GivesPicturesOfALostChunkAsUnreadable) {
  std::string bytes = read_bytes(bag_fixture("zstd.mcap"));
  bytes[1600] = static_cast<char>(bytes[1600] ^ 4);  // in the second chunk
  const fs::path bag = temporary_folder() / "hurt.mcap";
  write_text(bag, bytes);
  const auto frames = read_all(bag.string());
  ASSERT_EQ(frames.size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(frames[k].is_readable(), k != 2 && k != 3) << k;
  EXPECT_THAT(frames[2].error, HasSubstr("its chunk, at byte 1174, cannot be read"));
}

// Cameras.

fs::path bag_with_camera(const CameraInfoFields& info, const std::string& images = "/left/image_raw",
                         const std::string& infos = "/left/camera_info", Wire wire = Wire::kCdr) {
  const fs::path path = temporary_folder() / "camera.mcap";
  TestMessage picture = small_picture(images, kSecond);
  ImageFields fields = picture_of("mono8", "a");
  picture.bytes = image_message(wire, fields);
  write_mcap(path, wire,
             {picture, {infos, "sensor_msgs/CameraInfo", kSecond, camera_info_message(wire, info)}});
  return path;
}

const CameraInfoFields kInfo = {.width = 640,
                                .height = 480,
                                .model = "rational_polynomial",
                                .d = {0.1, -0.2, 0.001, -0.002, 0.03, 0.4, -0.05, 0.006, 0, 0, 0, 0, 0, 0},
                                .k = {400, 0, 321, 0, 410, 242, 0, 0, 1},
                                .p = {390, 0, 318, -40, 0, 395, 238, 0, 0, 0, 1, 0}};

std::vector<double> numbers_of(const Camera& camera) {
  const Pinhole& p = camera.model.pinhole();
  return {p.fx, p.fy, p.cx, p.cy, double(camera.width), double(camera.height)};
}

TEST(BagCamera, IsReadOfEitherByteOrderAndOfRos1) {
  for (const Wire wire : {Wire::kRos1, Wire::kCdr, Wire::kCdrBigEndian}) {
    const auto camera =
        bag_camera(bag_with_camera(kInfo, "/left/image_raw", "/left/camera_info", wire).string());
    ASSERT_TRUE(camera);
    EXPECT_EQ(numbers_of(*camera), (std::vector<double>{400, 410, 321, 242, 640, 480}));
    EXPECT_EQ(std::get<RadtanDistortion>(camera->model.distortion()).coefficients(),
              (std::vector{0.1, -0.2, 0.001, -0.002, 0.03, 0.4, -0.05, 0.006}));
  }
}

TEST(BagCamera, ReadsFisheyes) {
  for (const char* model : {"equidistant", "fisheye"}) {
    CameraInfoFields info = kInfo;
    info.model = model;
    info.d = {0.1, -0.02, 0.003, -0.0004};
    const auto camera = bag_camera(bag_with_camera(info).string());
    ASSERT_TRUE(camera);
    EXPECT_EQ(std::get<EquidistantDistortion>(camera->model.distortion()).coefficients(), info.d);
  }
}

TEST(BagCamera, LooksBesideTheTopic) {
  EXPECT_TRUE(bag_camera(bag_with_camera(kInfo, "/left/image_raw/compressed").string(), ""));
  EXPECT_TRUE(bag_camera(bag_with_camera(kInfo, "/image", "/camera_info").string()));
  EXPECT_FALSE(bag_camera(bag_with_camera(kInfo, "/right/image_raw").string()));
}

/// The picture's pixel (i, j) joins 2 x 3 pixels of the sensor: those from (100 + 2 i, 60 + 3 j) on. A point
/// that the sensor shows at its pixel (u, v) is at i = (u - 100 - 0.5) / 2, j = (v - 60 - 1) / 3.
TEST(BagCamera, HeedsBinningAndRegion) {
  CameraInfoFields info = kInfo;
  info.binning_x = 2;
  info.binning_y = 3;
  info.roi_x = 100;
  info.roi_y = 60;
  info.roi_width = 320;
  info.roi_height = 240;
  const auto camera = bag_camera(bag_with_camera(info).string());
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, 160);
  EXPECT_EQ(camera->height, 80);
  const auto full = bag_camera(bag_with_camera(kInfo).string());
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.1, -0.2, 1.0), Eigen::Vector3d(-0.3, 0.15, 1.2)}) {
    const Eigen::Vector2d of_sensor = *full->model.project(point), of_picture = *camera->model.project(point);
    EXPECT_NEAR(of_picture.x(), (of_sensor.x() - 100.5) / 2.0, 1e-9);
    EXPECT_NEAR(of_picture.y(), (of_sensor.y() - 61.0) / 3.0, 1e-9);
  }
}

TEST(BagCamera, TakesTheProjectionMatrixOfRectifiedPictures) {
  const auto camera = bag_camera(bag_with_camera(kInfo, "/left/image_rect").string());
  ASSERT_TRUE(camera);
  EXPECT_EQ(numbers_of(*camera), (std::vector<double>{390, 395, 318, 238, 640, 480}));
  EXPECT_EQ(camera->model.distortion_name(), "none");
}

TEST(BagCamera, SaysThatACameraWasNotCalibrated) {
  CameraInfoFields info = kInfo;
  info.k = std::vector<double>(9, 0.0);
  std::string told;
  EXPECT_FALSE(
      bag_camera(bag_with_camera(info).string(), "", [&](LogLevel, std::string_view text) { told = text; }));
  EXPECT_THAT(told, AllOf(HasSubstr("/left/camera_info"), HasSubstr("not calibrated")));
}

TEST(BagCamera, SaysThatItChanges) {
  const fs::path path = temporary_folder() / "camera.mcap";
  CameraInfoFields other = kInfo;
  other.k[0] = 401;
  std::vector<TestMessage> messages = {small_picture("/left/image_raw", kSecond)};
  for (int i = 0; i < 5; ++i)
    messages.push_back({"/left/camera_info", "sensor_msgs/CameraInfo", kSecond * (i + 1),
                        camera_info_message(Wire::kCdr, i == 4 ? other : kInfo)});
  write_mcap(path, Wire::kCdr, messages);
  std::string told;
  const auto camera = bag_camera(path.string(), "", [&](LogLevel, std::string_view text) { told = text; });
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->model.pinhole().fx, 400);
  EXPECT_THAT(told, HasSubstr("changes within the bag"));
}

TEST(BagCamera, RefusesOtherLenses) {
  const auto refused = [](const CameraInfoFields& info, const std::vector<std::string>& words) {
    const std::string path = bag_with_camera(info).string();
    expect_error(ErrorKind::kInvalidInput, words, [&] { bag_camera(path); });
  };
  CameraInfoFields info = kInfo;
  info.model = "double_sphere";
  refused(info, {"/left/camera_info", "'double_sphere' is not supported"});
  info = kInfo;
  info.d[9] = 0.1;
  refused(info, {"D has 14"});
  info = kInfo;
  info.k[4] = -3;
  refused(info, {"focal lengths must be > 0"});
}

}  // namespace
}  // namespace apriltrack::test
