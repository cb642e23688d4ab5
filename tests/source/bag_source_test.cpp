#include <gmock/gmock.h>

#include <map>

#include "apriltrack/source/bag_input.h"
#include "bag_pictures.h"
#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

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

// Topics.

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
  for (const std::int64_t stamp : {10, 11, 10, 11, 12}) {
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

/// Ten frames a second, recorded 20 ms later; `wrong` has some of the stamps by their numbers, in ns.
fs::path bag_with_wrong_stamps(const std::map<int, std::int64_t>& wrong, int count = 12) {
  std::vector<TestMessage> messages;
  for (int k = 0; k < count; ++k) {
    const std::int64_t right = 100 * kSecond + k * kSecond / 10;
    const auto other = wrong.find(k);
    messages.push_back(small_picture("/image", other == wrong.end() ? right : other->second));
    messages.back().log_time_ns = right + kSecond / 50;
  }
  const fs::path bag = temporary_folder() / "any.mcap";
  write_mcap(bag, Wire::kCdr, messages);
  return bag;
}

/// All but the wrong ones are given with their times.
void expect_only_these_lost(const std::map<int, std::int64_t>& wrong) {
  const auto frames = read_all(bag_with_wrong_stamps(wrong).string());
  ASSERT_EQ(frames.size(), 12u);
  for (int k = 0; k < 12; ++k) {
    const SourceFrame& frame = frames[static_cast<std::size_t>(k)];
    EXPECT_EQ(frame.is_readable(), !wrong.contains(k)) << k << ": " << frame.error;
    EXPECT_TRUE(!frame.is_readable() || frame.timestamp.ns == 100 * kSecond + k * kSecond / 10) << k;
    EXPECT_TRUE(k == 0 || frame.timestamp > frames[static_cast<std::size_t>(k) - 1].timestamp) << k;
  }
}

TEST(WrongStamps, ThatJumpAheadCostNoOtherFrame) {
  expect_only_these_lost({{1, 1'000'000'000 * kSecond}});
  expect_only_these_lost({{5, 101 * kSecond}});
  expect_only_these_lost({{5, 4'000'000'000 * kSecond}, {6, 4'000'000'001 * kSecond}});
  expect_only_these_lost({{0, 1'000'000'000 * kSecond}});
}

TEST(WrongStamps, ThatFallBackCostNoOtherFrame) {
  expect_only_these_lost({{5, 0}});
  expect_only_these_lost({{5, 50 * kSecond}, {8, 1}});
}

/// As Gazebo writes.
TEST(WrongStamps, OfZeroInTheBeginningAreThoseOfNoOtherFrame) {
  expect_only_these_lost({{0, 0}});
  expect_only_these_lost({{0, 0}, {1, 0}, {2, 0}});
}

TEST(WrongStamps, AreNoStepsOfAClock) {
  std::map<int, std::int64_t> later;
  for (int k = 4; k < 12; ++k) later[k] = 1'000'000'000 * kSecond + k * kSecond / 10;
  for (const SourceFrame& frame : read_all(bag_with_wrong_stamps(later).string())) EXPECT_EQ(frame.error, "");
}

TEST(WrongStamps, AreToldInWords) {
  const auto frames = read_all(bag_with_wrong_stamps({{0, 0}, {4, 500 * kSecond}}).string());
  EXPECT_THAT(frames.at(0).error, HasSubstr("header.stamp is 0"));
  EXPECT_THAT(frames.at(4).error, HasSubstr("500.000000000 s, is not before those of the frames after it"));
}

TEST(WrongStamps, AreLookedForWhileFramesAreLeftOut) {
  const fs::path bag = bag_with_wrong_stamps({{4, 500 * kSecond}});
  EXPECT_EQ(times_of(read_all(bag.string(), {.skip = 1, .step = 3}))[0], 100 * kSecond + kSecond / 10);
  const auto frames = read_all(bag.string(), {.skip = 1, .step = 3});
  ASSERT_EQ(frames.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(frames[i].is_readable(), i != 1) << frames[i].error;
  EXPECT_EQ(frames[3].timestamp.ns, 101 * kSecond);
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

// 480 rows, 10 us apart: the middle of row 239.5 is 2.395 ms after that of the first.
TEST(StampIs, OfARollingShutterIsMovedToItsMiddleRow) {
  const fs::path bag = temporary_folder() / "any.mcap";
  write_mcap(bag, Wire::kCdr, {small_picture("/image", kSecond)});
  const auto time_ns = [&](StampIs stamp_is) {
    return times_of(
               read_all(bag.string(), {.stamp_is = stamp_is, .exposure_s = 0.016, .readout_s = 479 * 10e-6}))
        .at(0);
  };
  EXPECT_EQ(time_ns(StampIs::kStart), kSecond + 8'000'000 + 2'395'000);
  EXPECT_EQ(time_ns(StampIs::kMiddle), kSecond);
  EXPECT_EQ(time_ns(StampIs::kEnd), kSecond - 8'000'000 - 2'395'000);
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

}  // namespace
}  // namespace apriltrack::test
