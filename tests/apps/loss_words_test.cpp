// What commands say of a conversion's losses.

#include "files/loss_words.h"

#include <gmock/gmock.h>

namespace apriltrack::app {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

ConversionStep step_of(ConversionStep::Stage stage) {
  return {stage, "TITLE", "file"};
}

TEST(LossWords, EveryKindHasASentenceWhateverBecameOfIt) {
  using enum LossHow;
  int num_kinds = 0;
  for (const LossKind kind : loss_kinds()) {
    ++num_kinds;
    for (const LossHow how : {kLeftOut, kAssumed, kGiven, kConverted, kUnknown}) {
      for (const auto stage : {ConversionStep::Stage::kRead, ConversionStep::Stage::kWrite}) {
        const ConversionLoss loss{
            .kind = kind, .how = how, .which = {"WHICH"}, .value = "VALUE", .numbers = {1.5, 2.5, 3.5}};
        EXPECT_GT(sentence_of(loss, step_of(stage)).size(), 10U) << to_string(kind) << ", " << to_string(how);
      }
    }
  }
  EXPECT_EQ(num_kinds, 27);
}

TEST(LossWords, OfACameraNameIt) {
  int num_kinds = 0;
  for (const LossKind kind : loss_kinds()) {
    const bool moves_points = kind == LossKind::kSkew || kind == LossKind::kLensTerms;  // these name the line
    if (subject_of(kind) != LossSubject::kCamera || moves_points) continue;
    ++num_kinds;
    const ConversionLoss loss{.kind = kind, .which = {"front"}, .value = "VALUE", .numbers = {1.5, 2.5}};
    EXPECT_THAT(sentence_of(loss, step_of(ConversionStep::Stage::kRead)), HasSubstr("'front'"))
        << to_string(kind);
  }
  EXPECT_EQ(num_kinds, 10);
}

std::string words_of_place(const std::string& key, std::vector<double> numbers = {}) {
  return sentence_of({.kind = LossKind::kExtrinsics, .which = {"cam0"}, .value = key, .numbers = numbers},
                     step_of(ConversionStep::Stage::kRead));
}

TEST(LossWords, OfAPlaceSayInRelationToWhat) {
  EXPECT_EQ(words_of_place("T_cam_imu"),
            "not kept: camera 'cam0': its place relative to the IMU (T_cam_imu)");
  EXPECT_EQ(words_of_place("timeshift_cam_imu"),
            "not kept: camera 'cam0': its clock relative to the IMU (timeshift_cam_imu)");
  EXPECT_THAT(words_of_place("T_BS"), HasSubstr("its place on the body (T_BS)"));
  EXPECT_THAT(words_of_place("rt_cam_ref: [1, 2, 3, 4, 5, 6]"),
              HasSubstr("its place in the reference frame (rt_cam_ref: [1, 2, 3, 4, 5, 6])"));
  EXPECT_EQ(
      words_of_place("projection_matrix", {0.12, 0.0}),
      "not kept: camera 'cam0': its place on a stereo rig (projection_matrix: 0.12 m right of the other "
      "camera, 0 m below)");
}

}  // namespace
}  // namespace apriltrack::app
