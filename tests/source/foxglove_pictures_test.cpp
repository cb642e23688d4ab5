// Pictures and cameras in Foxglove's messages. The bytes are written field by field as foxglove/foxglove-sdk
// numbers them (schemas/proto/foxglove/RawImage.proto, CompressedImage.proto, CameraCalibration.proto).
#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>

#include "apriltrack/source/bag_input.h"
#include "apriltrack/source/image_file.h"
#include "bag/protobuf_bytes.h"
#include "bag_pictures.h"
#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

/// A picture of 6 x 4 whose pixels all differ, with two bytes behind each row.
constexpr int kStep = kWide + 2;
std::string rows() {
  std::string bytes(kStep * kHigh, '\x77');
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x)
      bytes[static_cast<std::size_t>(kStep * y + x)] = static_cast<char>(9 * y + x);
  return bytes;
}
GrayImage picture() {
  GrayImage image(kWide, kHigh);
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) image(x, y) = static_cast<std::uint8_t>(9 * y + x);
  return image;
}
std::string png_of(const cv::Mat& pixels) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", pixels, bytes);
  return {bytes.begin(), bytes.end()};
}
std::string png() {
  const std::string pixels = rows();
  return png_of(cv::Mat(kHigh, kWide, CV_8UC1, const_cast<char*>(pixels.data()), kStep));
}

std::string raw_image(const std::string& encoding = "mono8") {
  return time_field(1'700'000'000, 123'456'789) + fixed32_field(2, kWide) + fixed32_field(3, kHigh) +
         bytes_field(4, encoding) + fixed32_field(5, kStep) + bytes_field(6, rows()) +
         bytes_field(7, "camera");
}
std::string compressed_image(const std::string& time = time_field(1'700'000'000, 123'456'789)) {
  return time + bytes_field(2, png()) + bytes_field(3, "png") + bytes_field(4, "camera");
}

fs::path bag_with(const std::string& type, const std::string& message, Wire wire = Wire::kProtobuf) {
  return bag_of({message}, type, wire);
}

void expect_picture(const fs::path& bag) {
  const std::vector<SourceFrame> frames = read_all(bag.string());
  ASSERT_EQ(frames.size(), 1u);
  ASSERT_EQ(frames[0].error, "");
  EXPECT_EQ(frames[0].timestamp.ns, 1'700'000'000'123'456'789);
  EXPECT_THAT(frames[0].pixels, SamePixels(picture()));
}

TEST(FoxglovePictures, AreReadOfProtobuf) {
  expect_picture(bag_with("foxglove.RawImage", raw_image()));
  expect_picture(bag_with("foxglove.CompressedImage", compressed_image()));
}

/// Fields in another order, and one that a later schema may have.
TEST(FoxglovePictures, AreReadWhateverTheOrderOfTheirFields) {
  expect_picture(bag_with("foxglove.CompressedImage",
                          bytes_field(4, "camera") + varint_field(200, 1ull << 63) + bytes_field(3, "png") +
                              bytes_field(2, png()) + fixed32_field(77, 5) +
                              time_field(1'700'000'000, 123'456'789)));
}

/// The text is what `base64` of coreutils prints of the bytes 0 1 2 9 10 11.
TEST(FoxglovePictures, AreReadOfJson) {
  const fs::path bag = bag_with(
      "foxglove.RawImage",
      R"({"timestamp": {"sec": 1700000000, "nsec": 123456789}, "frame_id": "camera", "width": 3, "height": 2,)"
      R"( "encoding": "mono8", "step": 3, "data": "AAECCQoL"})",
      Wire::kJson);
  const std::vector<SourceFrame> frames = read_all(bag.string());
  ASSERT_EQ(frames.size(), 1u);
  ASSERT_EQ(frames[0].error, "");
  EXPECT_EQ(frames[0].timestamp.ns, 1'700'000'000'123'456'789);
  GrayImage expected(3, 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) expected(x, y) = static_cast<std::uint8_t>(9 * y + x);
  EXPECT_THAT(frames[0].pixels, SamePixels(expected));
}

/// A PGM file of two pixels, 1 and 254, in the three lengths that base64 has ends for: "P5 2 1 255\n" and the
/// pixels, and one and two bytes more.
TEST(FoxglovePictures, AreReadOfBase64WithEveryEnd) {
  for (const char* data :
       {"UDUgMiAxIDI1NQoB/g==", "UDUgMiAxIDI1NQoB/gA=", "UDUgMiAxIDI1NQoB/gAA", "UDUgMiAxIDI1NQoB/g"}) {
    const fs::path bag = bag_with(
        "foxglove.CompressedImage",
        fmt::format(
            R"({{"timestamp": {{"sec": 1, "nsec": 5}}, "frame_id": "c", "format": "pgm", "data": "{}"}})",
            data),
        Wire::kJson);
    const std::vector<SourceFrame> frames = read_all(bag.string());
    ASSERT_EQ(frames.at(0).error, "") << data;
    EXPECT_EQ(frames[0].timestamp.ns, 1'000'000'005);
    ASSERT_EQ(frames[0].pixels.width(), 2);
    EXPECT_EQ(frames[0].pixels(0, 0), 1);
    EXPECT_EQ(frames[0].pixels(1, 0), 254);
  }
}

TEST(FoxglovePictures, NeedARateWithoutTimes) {
  const fs::path bag = bag_with("foxglove.CompressedImage", compressed_image(""));
  expect_refused(bag, ErrorKind::kInvalidInput, {"carry no times", "--rate HZ"});
  EXPECT_EQ(read_all(bag.string(), {.rate_hz = 10.0}).at(0).error, "");
}

TEST(FoxglovePictures, OfOtherEncodingsAreRefusedByName) {
  expect_refused(bag_with("foxglove.RawImage", raw_image("32FC1")), ErrorKind::kInvalidInput,
                 {"/camera/image", "'32FC1' is not read"});
  expect_refused(bag_of({raw_image()}, "foxglove.RawImage", Wire::kRos1), ErrorKind::kInvalidInput,
                 {"encoded as 'ros1'", "protobuf and json"});
}

/// Each is a frame that cannot be read, and the one after it is read.
TEST(FoxglovePictures, ThatAreBrokenAreUnreadableFrames) {
  const auto at = [](int second) { return time_field(static_cast<std::uint64_t>(second), 0); };
  const std::string whole = compressed_image(at(1));
  const std::vector<std::string> broken = {
      whole.substr(0, whole.size() / 2),               // cut off
      bytes_field(1, varint_field(2, 1'000'000'000)),  // nanoseconds of a second
      bytes_field(1, varint_field(1, 1ull << 62)),     // seconds beyond 64 bits
      varint(8 * 2 + 3),                               // a group
      std::string(11, '\xff'),                         // a number without an end
      std::string(1, '\0'),                            // field 0
      varint_field(1, 1) + bytes_field(2, png()),      // a number in place of the time
      bytes_field(1, varint_field(1, 2) + bytes_field(2, "5")) + bytes_field(2, png()) +
          bytes_field(3, "png"),  // text in place of nanoseconds
      at(1) + bytes_field(2, png().substr(0, 40)) + bytes_field(3, "png")};
  for (std::size_t i = 0; i < broken.size(); ++i) {
    SCOPED_TRACE(i);
    const std::vector<SourceFrame> frames =
        read_all(bag_of({compressed_image(at(1)), broken[i], compressed_image(at(3))},
                        "foxglove.CompressedImage", Wire::kProtobuf)
                     .string());
    ASSERT_EQ(frames.size(), 3u);
    EXPECT_EQ(frames[0].error, "");
    EXPECT_NE(frames[1].error, "");
    EXPECT_EQ(frames[2].error, "");
    EXPECT_EQ(frames[2].timestamp.ns, 3 * kSecond);
  }
}

TEST(FoxglovePictures, OfBrokenJsonSayWhatIsWrong) {
  const std::string good =
      R"({"timestamp": {"sec": 1, "nsec": 0}, "format": "pgm", "data": "UDUgMiAxIDI1NQoB/g=="})";
  const auto error_of = [&](const std::string& message) {
    return read_all(bag_of({good, message}, "foxglove.CompressedImage", Wire::kJson).string()).at(1).error;
  };
  EXPECT_THAT(error_of(R"({"timestamp": {"sec": 2, "nsec": 0}, "format": "pgm", "data": "UDU*"})"),
              HasSubstr("data: is not base64"));
  EXPECT_THAT(error_of(R"({"timestamp": {"sec": 2, "nsec": 0}, "format": "pgm"})"), HasSubstr("data"));
}

// Cameras.

const std::vector<double> kMatrix = {400.1, 0, 321.25, 0, 410.3, 242.75, 0, 0, 1};
const std::vector<double> kProjection = {390, 0, 318, -40, 0, 395, 238, 0, 0, 0, 1, 0};
const std::vector<double> kFisheye = {0.1, -0.02, 0.003, -0.0004};

std::string calibration(bool is_packed = true, const std::vector<double>& k = kMatrix) {
  return time_field(1, 0) + fixed32_field(2, 640) + fixed32_field(3, 480) + bytes_field(4, "kannala_brandt") +
         doubles_field(5, kFisheye, is_packed) + doubles_field(6, k, is_packed) +
         doubles_field(7, {1, 0, 0, 0, 1, 0, 0, 0, 1}, is_packed) + doubles_field(8, kProjection, is_packed) +
         bytes_field(9, "camera");
}

fs::path bag_with_camera(const std::string& message, Wire wire, const std::string& images = "/camera/image",
                         const std::string& infos = "/camera/calibration") {
  const fs::path path = temporary_folder() / "camera.mcap";
  const std::string json_image = R"({"timestamp": {"sec": 1, "nsec": 0}, "format": "pgm", "data": ""})";
  write_mcap(
      path, wire,
      {{images, "foxglove.CompressedImage", kSecond, wire == Wire::kJson ? json_image : compressed_image()},
       {infos, "foxglove.CameraCalibration", kSecond, message}});
  return path;
}

void expect_camera(const std::optional<Camera>& camera) {
  ASSERT_TRUE(camera);
  const Pinhole& p = camera->model.pinhole();
  EXPECT_EQ((std::vector{p.fx, p.fy, p.cx, p.cy}), (std::vector{400.1, 410.3, 321.25, 242.75}));
  EXPECT_EQ(camera->width, 640);
  EXPECT_EQ(camera->height, 480);
  EXPECT_EQ(std::get<EquidistantDistortion>(camera->model.distortion()).coefficients(), kFisheye);
}

TEST(FoxgloveCameras, AreReadOfProtobuf) {
  for (const bool is_packed : {true, false})
    expect_camera(bag_camera(bag_with_camera(calibration(is_packed), Wire::kProtobuf).string()));
}

TEST(FoxgloveCameras, AreReadOfJson) {
  const std::string text =
      R"({"timestamp": {"sec": 1, "nsec": 0}, "frame_id": "camera", "width": 640, "height": 480,)"
      R"( "distortion_model": "kannala_brandt", "D": [0.1, -0.02, 0.003, -0.0004],)"
      R"( "K": [400.1, 0, 321.25, 0, 410.3, 242.75, 0, 0, 1], "R": [1, 0, 0, 0, 1, 0, 0, 0, 1],)"
      R"( "P": [390, 0, 318, -40, 0, 395, 238, 0, 0, 0, 1, 0]})";
  expect_camera(bag_camera(bag_with_camera(text, Wire::kJson).string()));
}

/// Rectified pictures, as nuscenes2mcap names them.
TEST(FoxgloveCameras, OfRectifiedPicturesAreTheirProjection) {
  const auto camera = bag_camera(bag_with_camera(calibration(), Wire::kProtobuf,
                                                 "/CAM_BACK/image_rect_compressed", "/CAM_BACK/camera_info")
                                     .string());
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->model.pinhole().fx, 390);
  EXPECT_EQ(camera->model.distortion_name(), "none");
}

TEST(FoxgloveCameras, ThatTellNothingAreNone) {
  EXPECT_FALSE(bag_camera(bag_with_camera(calibration(true, {}), Wire::kProtobuf).string()));  // no matrix
  EXPECT_FALSE(
      bag_camera(bag_with_camera(calibration(true, {1, 2, 3}), Wire::kProtobuf).string()));  // not 3 x 3
  EXPECT_FALSE(
      bag_camera(bag_with_camera(calibration(), Wire::kProtobuf, "/left/image").string()));  // of another
}

}  // namespace
}  // namespace apriltrack::test
