#include "apriltrack/io/conversion_loss.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

// The words of docs/file_formats.md, one of each end of what belongs together.
TEST(ConversionLoss, HasTheWordsOfTheDocuments) {
  using enum LossKind;
  const std::pair<LossKind, std::string_view> words[] = {{kSizes, "sizes"},
                                                         {kFrameName, "frame_name"},
                                                         {kMatrixOrder, "matrix_order"},
                                                         {kForeignKeys, "foreign_keys"},
                                                         {kResolution, "resolution"},
                                                         {kLineDelay, "line_delay"},
                                                         {kRectification, "rectification"},
                                                         {kFurtherCameras, "further_cameras"},
                                                         {kCameraKeys, "camera_keys"},
                                                         {kUnreadLens, "unread_lens"},
                                                         {kTimes, "times"},
                                                         {kBiases, "biases"}};
  for (const auto& [kind, word] : words) EXPECT_EQ(to_string(kind), word);
  EXPECT_EQ(subject_of(kForeignKeys), LossSubject::kMap);
  EXPECT_EQ(subject_of(kResolution), LossSubject::kCamera);
  EXPECT_EQ(subject_of(kCameraKeys), LossSubject::kCamera);
  EXPECT_EQ(subject_of(kTimes), LossSubject::kTrajectory);
  EXPECT_EQ(to_string(LossHow::kLeftOut), "left_out");
  EXPECT_EQ(to_string(LossHow::kAssumed), "assumed");
  EXPECT_EQ(to_string(LossHow::kGiven), "given");
  EXPECT_EQ(to_string(LossHow::kConverted), "converted");
  EXPECT_EQ(to_string(LossHow::kUnknown), "unknown");
}

}  // namespace
}  // namespace apriltrack
