#include <gmock/gmock.h>

#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

class Euroc : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = temporary_folder();
    camera_ = root_ / "mav0" / "cam0";
    write_frames(camera_ / "data", {"1403636579763555584.pgm", "1403636579813555456.pgm"});
    write_csv(
        "1403636579763555584,1403636579763555584.pgm\r\n1403636579813555456,1403636579813555456.pgm\r\n");
  }
  void write_csv(const std::string& rows) const {
    write_text(camera_ / "data.csv", "#timestamp [ns],filename\r\n" + rows);
  }

  fs::path root_;
  fs::path camera_;
};

TEST_F(Euroc, IsReadFromItsRootItsMav0AndItsCameraFolder) {
  for (const fs::path& input : {root_, root_ / "mav0", camera_}) {
    const auto frames = read_all(input.string());
    EXPECT_THAT(times_of(frames), ElementsAre(1403636579763555584, 1403636579813555456)) << input;
    EXPECT_THAT(frames[1].pixels, SamePixels(test_picture(8, 6, 1)));
  }
}

TEST_F(Euroc, TakesTheCameraThatIsAskedFor) {
  const fs::path second = root_ / "mav0" / "cam1";
  write_text(second / "data.csv", "#timestamp [ns],filename\n7,7.pgm\n");
  fs::create_directories(second / "data");
  write_pgm(second / "data" / "7.pgm", test_picture(8, 6, 42));
  write_text(root_ / "mav0" / "imu0" / "data.csv", "#timestamp [ns],w_RS_S_x\n");
  for (const fs::path& input : {root_, root_ / "mav0"}) {
    const auto frames = read_all(input.string(), {.camera_name = "cam1"});
    ASSERT_THAT(times_of(frames), ElementsAre(7)) << input;
    EXPECT_THAT(frames[0].pixels, SamePixels(test_picture(8, 6, 42)));
    EXPECT_EQ(read_all(input.string(), {.camera_name = "cam0"}).size(), 2U);
    expect_refused(input, ErrorKind::kInvalidInput, {input.string(), "no camera 'imu1'", "has: cam0, cam1;"},
                   {.camera_name = "imu1"});
  }
  // The folder of one camera is that camera, whatever its file calls it.
  EXPECT_THAT(times_of(read_all(second.string(), {.camera_name = "left"})), ElementsAre(7));
  fs::remove_all(camera_);
  expect_refused(root_, ErrorKind::kInvalidInput, {"no camera 'cam0'", "has: cam1;", "--camera-name"});
}

TEST_F(Euroc, TakesTheTimeFromTheTableAndNotFromTheName) {
  write_csv("5000,1403636579813555456.pgm\n");
  EXPECT_THAT(times_of(read_all(camera_.string())), ElementsAre(5000));
}

TEST_F(Euroc, CountsAListedButMissingImageAsUnreadable) {
  write_csv("1,gone.pgm\n2,1403636579813555456.pgm\n");
  const auto frames = read_all(camera_.string());
  ASSERT_THAT(times_of(frames), ElementsAre(1, 2));
  EXPECT_EQ(frames[0].error, "cannot be read: No such file or directory");
  EXPECT_TRUE(frames[1].is_readable());
}

TEST_F(Euroc, RefusesAWrongTable) {
  write_csv("2,a.pgm\n1,b.pgm\n");
  expect_refused(camera_, ErrorKind::kInvalidInput, {"data.csv:3", "later", "is 1"});
  write_csv("2,a.pgm\n2,b.pgm\n");
  expect_refused(camera_, ErrorKind::kInvalidInput, {"data.csv:3"});
  write_csv("2,\n");
  expect_refused(camera_, ErrorKind::kInvalidInput, {"data.csv:2", "filename"});
  write_csv("");
  expect_refused(camera_, ErrorKind::kIo, {"data.csv", "lists no images"});
  write_text(camera_ / "data.csv", "1,a.pgm\n");
  expect_refused(camera_, ErrorKind::kInvalidInput, {"data.csv", "timestamp [ns]"});
}

}  // namespace
}  // namespace apriltrack::test
