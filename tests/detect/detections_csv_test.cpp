#include "apriltrack/detect/detections_csv.h"

#include <gmock/gmock.h>

#include <fstream>

#include "apriltrack/base/error.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kHeader =
    "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y,hamming,margin\n";

std::filesystem::path write_text(const std::string& text) {
  const std::filesystem::path path = test::temporary_folder() / "detections.csv";
  std::ofstream(path) << text;
  return path;
}

std::string message_of(const std::string& text) {
  try {
    read_detections_csv(write_text(text));
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    return error.what();
  }
  return "accepted";
}

TEST(DetectionsCsv, ReadsRowsIntoFrames) {
  const auto frames = read_detections_csv(
      write_text(std::string(kHeader) + "1403715282262142976,cam0,tag36h11,3,1,2,3,4,5,6,7,8.5,1,40.25\n"
                                        "1403715282262142976,cam1,tag36h11,3,1,2,3,4,5,6,7,8,,\n"
                                        "1403715282262142976,cam0,tag25h9,0,-1,2,3,4,5,6,7,8,0,9\n"
                                        "1403715282312142848,cam0,tag36h11,3,1,2,3,4,5,6,7,8,0,9\n"));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].timestamp.ns, 1403715282262142976);
  EXPECT_EQ(frames[0].camera, "cam0");
  ASSERT_EQ(frames[0].detections.size(), 2U);
  EXPECT_EQ(frames[0].detections[0].tag, (TagKey{"tag36h11", 3}));
  EXPECT_EQ(frames[0].detections[0].corners_px[3], Eigen::Vector2d(7.0, 8.5));
  EXPECT_EQ(frames[0].detections[0].hamming, 1);
  EXPECT_EQ(frames[0].detections[0].decision_margin, 40.25);
  EXPECT_EQ(frames[0].detections[1].tag, (TagKey{"tag25h9", 0}));
  EXPECT_EQ(frames[1].camera, "cam1");
  EXPECT_FALSE(frames[1].detections.at(0).hamming.has_value());
  EXPECT_FALSE(frames[1].detections.at(0).decision_margin.has_value());
  EXPECT_EQ(frames[2].timestamp.ns, 1403715282312142848);
}

TEST(DetectionsCsv, NeedsNoHammingAndNoMarginAndTakesAnyFamilyAsALabel) {
  const auto frames = read_detections_csv(write_text(
      "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n5,left,aruco,3,1,2,3,4,5,6,7,8\n"));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].detections.at(0).tag.family, "aruco");
  EXPECT_FALSE(frames[0].detections[0].hamming.has_value());
}

TEST(DetectionsCsv, RefusalsNameLineColumnAndValue) {
  const std::string header = kHeader;
  EXPECT_THAT(message_of(header + "1,cam0,tag36h11,3,1,2,3,x4,5,6,7,8,0,9\n"),
              AllOf(HasSubstr("detections.csv:2"), HasSubstr("c1y"), HasSubstr("x4")));
  EXPECT_THAT(message_of(header + "1,cam0,tag36h11,3,1,2,nan,4,5,6,7,8,0,9\n"),
              AllOf(HasSubstr(":2"), HasSubstr("c1x")));
  EXPECT_THAT(message_of(header + "1,cam0,tag36h11,3,1,2,,4,5,6,7,8,0,9\n"),
              AllOf(HasSubstr(":2"), HasSubstr("c1x")));
  EXPECT_THAT(message_of(header + "1,cam0,tag36h11,-3,1,2,3,4,5,6,7,8,0,9\n"),
              AllOf(HasSubstr("id"), HasSubstr("-3")));
  EXPECT_THAT(message_of(header + "1.5,cam0,tag36h11,3,1,2,3,4,5,6,7,8,0,9\n"), HasSubstr("timestamp_ns"));
  EXPECT_THAT(message_of(header + "1,,tag36h11,3,1,2,3,4,5,6,7,8,0,9\n"), HasSubstr("camera"));
  EXPECT_THAT(message_of(header + "1,cam0,,3,1,2,3,4,5,6,7,8,0,9\n"), HasSubstr("family"));
  EXPECT_THAT(message_of(header + "1,cam0,tag36h11,3,1,2,3,4,5,6,7,8,-1,9\n"), HasSubstr("hamming"));
  EXPECT_THAT(message_of(header + "1,cam0,tag36h11,3,1,2,3,4,5,6,7,8,0,inf\n"), HasSubstr("margin"));
  EXPECT_THAT(message_of(header + "1,cam0,tag36h11,3,1,2,3\n"), HasSubstr(":2"));
  EXPECT_THAT(message_of("timestamp_ns,camera,id\n1,cam0,3\n"), HasSubstr("family"));
}

TEST(DetectionsCsv, TimeRunsForwardWithinACameraOnly) {
  const std::string header = kHeader;
  const std::string tail = ",tag36h11,3,1,2,3,4,5,6,7,8,0,9\n";
  EXPECT_EQ(message_of(header + "20,cam0" + tail + "10,cam1" + tail + "21,cam0" + tail), "accepted");
  EXPECT_THAT(message_of(header + "20,cam0" + tail + "10,cam1" + tail + "19,cam0" + tail),
              AllOf(HasSubstr(":4"), HasSubstr("cam0"), HasSubstr("backwards"), HasSubstr("19")));
}

TEST(DetectionsCsv, MissingFilesAreIoErrors) {
  try {
    read_detections_csv(test::temporary_folder() / "none.csv");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
  }
  try {
    write_detections_csv(test::temporary_folder() / "no" / "folder.csv", {});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
  }
}

TEST(DetectionsCsv, ReadsBackWhatItWrites) {
  FrameDetections frame{Timestamp{1403715282262142976}, "cam1", {}};
  Detection detection{{"tag36h11", 35}, {}, 2, 61.125};
  for (std::size_t k = 0; k < kNumCorners; ++k)
    detection.corners_px[k] = {100.123456 + static_cast<double>(k), -3.5 * static_cast<double>(k)};
  frame.detections = {detection, {{"tag25h9", 1}, detection.corners_px, std::nullopt, std::nullopt}};
  const std::filesystem::path path = test::temporary_folder() / "detections.csv";
  write_detections_csv(path, std::vector{frame});
  const auto frames = read_detections_csv(path);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].timestamp, frame.timestamp);
  EXPECT_EQ(frames[0].camera, "cam1");
  ASSERT_EQ(frames[0].detections.size(), 2U);
  EXPECT_EQ(frames[0].detections[0].tag, detection.tag);
  EXPECT_EQ(frames[0].detections[0].hamming, 2);
  EXPECT_EQ(frames[0].detections[0].decision_margin, 61.125);
  EXPECT_FALSE(frames[0].detections[1].hamming.has_value());
  for (std::size_t k = 0; k < kNumCorners; ++k)
    EXPECT_LT((frames[0].detections[0].corners_px[k] - detection.corners_px[k]).norm(), 1e-6);
}

/// The header with all 36 columns of the covariance, but for `left_out`.
std::string header_with_covariance(const std::string& left_out = "") {
  std::string header = "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y";
  for (int i = 0; i < 8; ++i) {
    for (int j = i; j < 8; ++j) {
      const std::string name = "cov_" + std::to_string(i) + std::to_string(j);
      if (name != left_out) header += "," + name;
    }
  }
  return header + "\n";
}

/// A row with `diagonal` on the covariance's diagonal and `other` beside it.
std::string row_with_covariance(const std::string& diagonal, const std::string& other) {
  std::string row = "5,cam0,tag36h11,3,1,2,3,4,5,6,7,8";
  for (int i = 0; i < 8; ++i)
    for (int j = i; j < 8; ++j) row += "," + (i == j ? diagonal : other);
  return row + "\n";
}

TEST(DetectionsCsvCovariance, IsKeptOnARoundTrip) {
  CornerCovariance covariance;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) covariance(i, j) = i == j ? 0.01 + 0.001 * i : 1e-4 * (1 + i + j) / 16.0;
  const std::vector<FrameDetections> frames = {
      {{7},
       "cam0",
       {{{"tag36h11", 1}, {}, 0, 30.0, covariance}, {{"tag36h11", 2}, {}, 0, 30.0, std::nullopt}}}};
  const std::filesystem::path path = test::temporary_folder() / "covariance.csv";
  write_detections_csv(path, frames);
  const auto read = read_detections_csv(path);
  ASSERT_EQ(read.at(0).detections.size(), 2U);
  ASSERT_TRUE(read[0].detections[0].covariance_px2);
  EXPECT_LT((*read[0].detections[0].covariance_px2 - covariance).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_FALSE(read[0].detections[1].covariance_px2);
}

TEST(DetectionsCsvCovariance, IsReadAsTheUpperTriangleRowByRow) {
  std::string row = "5,cam0,tag36h11,3,1,2,3,4,5,6,7,8";
  for (int i = 0; i < 8; ++i)
    for (int j = i; j < 8; ++j) row += "," + std::to_string(i == j ? 1.0 + i : 0.01 * i + 0.001 * j);
  const auto frames = read_detections_csv(write_text(header_with_covariance() + row + "\n"));
  const CornerCovariance& covariance = *frames.at(0).detections.at(0).covariance_px2;
  EXPECT_EQ(covariance(3, 3), 4.0);
  EXPECT_NEAR(covariance(2, 5), 0.025, 1e-12);
  EXPECT_NEAR(covariance(5, 2), 0.025, 1e-12);
}

TEST(DetectionsCsvCovariance, IsNotWrittenWhereNobodyHasOne) {
  const std::filesystem::path path = test::temporary_folder() / "plain.csv";
  write_detections_csv(path,
                       std::vector<FrameDetections>{{{7}, "cam0", {{{"tag36h11", 1}, {}, 0, 30.0, {}}}}});
  std::ifstream file(path);
  std::string header;
  std::getline(file, header);
  EXPECT_EQ(header + "\n", kHeader);
}

TEST(DetectionsCsvCovariance, NamesLineAndColumnOfWhatIsWrong) {
  EXPECT_THAT(message_of(header_with_covariance("cov_37")),
              AllOf(HasSubstr(".csv:1"), HasSubstr("cov_37"), HasSubstr("missing")));
  const std::string header = header_with_covariance();
  EXPECT_THAT(message_of(header + row_with_covariance("nan", "0")),
              AllOf(HasSubstr(".csv:2"), HasSubstr("cov_00")));
  EXPECT_THAT(message_of(header + row_with_covariance("-1", "0")),
              AllOf(HasSubstr(".csv:2"), HasSubstr("cov_00"), HasSubstr("> 0")));
  EXPECT_THAT(message_of(header + row_with_covariance("1", "")),
              AllOf(HasSubstr(".csv:2"), HasSubstr("cov_01"), HasSubstr("empty")));
  EXPECT_THAT(message_of(header + row_with_covariance("1", "1.5")),
              AllOf(HasSubstr(".csv:2"), HasSubstr("positive definite")));
}

}  // namespace
}  // namespace apriltrack
