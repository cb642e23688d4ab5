#include <gmock/gmock.h>

#include <algorithm>

#include "filmed_cameras.h"

// Cameras that are not as their file says, and detectors that put edges beside the true ones.

namespace apriltrack {
namespace {

using test::by;
using test::calibrate;
using test::expect_truth;
using test::film;
using test::film_with_two_cameras;
using test::Filmed;
using test::move_edges_inward;
using test::scale_focal_length;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const CameraCorrection* correction(const CalibrationResult& result, const std::string& parameter) {
  const auto found = std::ranges::find(result.corrections, parameter, &CameraCorrection::parameter);
  return found == result.corrections.end() ? nullptr : &*found;
}

TEST(CameraRefinement, FindsAWrongFocalLengthAndSaysSo) {
  for (const double factor : {0.94, 1.03}) {
    Filmed filmed = film(test::perspective_camera());
    scale_focal_length(filmed.stated.rig.cameras[0], factor);
    const CalibrationResult result = calibrate(filmed.stated, filmed.frames);
    const CameraCorrection* focal = correction(result, "focal length");
    ASSERT_NE(focal, nullptr) << factor;
    EXPECT_NEAR(focal->value, 1.0 / factor - 1.0, 5.0 * focal->sigma);
    EXPECT_LT(focal->sigma, 0.003);
    EXPECT_NEAR(result.rig.cameras[0].model.pinhole().fx, filmed.truth.rig.cameras[0].model.pinhole().fx,
                3.0);
    EXPECT_EQ(result.map.tags.size(), 14u);
    expect_truth(filmed.truth, result.map, result.held_tag, 0.02, 0.01);
    EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("focal length")));
  }
}

TEST(CameraRefinement, FindsAWrongFocalLengthBesideATagOfAWrongSize) {
  Filmed filmed = film(test::perspective_camera(), 0.2, 60);
  scale_focal_length(filmed.stated.rig.cameras[0], 1.02);
  filmed.stated.map.tags[5].size_m *= 1.03;
  const CalibrationResult result = calibrate(filmed.stated, filmed.frames);
  const CameraCorrection* focal = correction(result, "focal length");
  ASSERT_NE(focal, nullptr);
  EXPECT_NEAR(focal->value, 1.0 / 1.02 - 1.0, 5.0 * focal->sigma);
  EXPECT_LT(focal->sigma, 0.006);
  EXPECT_EQ(result.map.tags.size(), 13u);
  EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("smaller than its stated size")));
  expect_truth(filmed.truth, result.map, result.held_tag, 0.02, 0.01);
}

/// Edge offsets are found with the tag in the map, and estimated anew without it; a lens that is so little
/// off only then.
TEST(CameraRefinement, FindsAWrongFocalLengthBesideATagOfAWrongSizeAndAnEdgeOffset) {
  Filmed filmed = film(test::perspective_camera(), 0.2, 60);
  move_edges_inward(0.2, filmed.frames);
  scale_focal_length(filmed.stated.rig.cameras[0], 1.01);
  filmed.stated.map.tags[5].size_m *= 1.03;
  const CalibrationResult result = calibrate(filmed.stated, filmed.frames, {.edge_offset_sigma_px = 0.2});
  const CameraCorrection* focal = correction(result, "focal length");
  ASSERT_NE(focal, nullptr);
  EXPECT_NEAR(focal->value, 1.0 / 1.01 - 1.0, 5.0 * focal->sigma);
  EXPECT_LT(focal->sigma, 0.006);
  const CameraCorrection* offset = correction(result, "edge offset");
  ASSERT_NE(offset, nullptr);
  EXPECT_NEAR(offset->value, 0.2, 5.0 * offset->sigma);
  EXPECT_LT(offset->sigma, 0.1);
  expect_truth(filmed.truth, result.map, result.held_tag, 0.02, 0.01);
}

/// Cameras are tested and fitted side by side, tags looked at by several maps at once.
TEST(CameraRefinement, DoesNotDependOnTheNumberOfThreads) {
  Filmed filmed = film(test::perspective_camera(), 0.2, 60);
  scale_focal_length(filmed.stated.rig.cameras[0], 1.03);
  filmed.stated.map.tags[5].size_m *= 1.1;
  const CalibrationResult one = calibrate(filmed.stated, filmed.frames, {.num_threads = 1});
  const CalibrationResult three = calibrate(filmed.stated, filmed.frames, {.num_threads = 3});
  ASSERT_NE(correction(one, "focal length"), nullptr);
  ASSERT_NE(correction(three, "focal length"), nullptr);
  EXPECT_EQ(correction(one, "focal length")->value, correction(three, "focal length")->value);
  EXPECT_EQ(one.warnings, three.warnings);
  ASSERT_EQ(one.map.tags.size(), three.map.tags.size());
  for (std::size_t i = 0; i < one.map.tags.size(); ++i) {
    EXPECT_EQ(one.map.tags[i].T_map_tag.matrix(), three.map.tags[i].T_map_tag.matrix());
    EXPECT_EQ(*one.map.tags[i].covariance, *three.map.tags[i].covariance);
  }
}

TEST(CameraRefinement, SpeaksOfALensThatIsKeptAsItIsWithoutTheFaultyTag) {
  Filmed filmed = film(test::perspective_camera(), 0.2, 60);
  filmed.stated.map.tags[5].size_m *= 1.03;
  const auto warnings = [&] {
    return calibrate(filmed.stated, filmed.frames, {.intrinsics = Intrinsics::kKeep}).warnings;
  };
  EXPECT_THAT(warnings(), Not(::testing::Contains(HasSubstr("the camera file does not fit"))));
  scale_focal_length(filmed.stated.rig.cameras[0], 1.02);
  EXPECT_THAT(warnings(), ::testing::Contains(HasSubstr("the camera file does not fit")));
}

TEST(CameraRefinement, LeavesARightCameraAlone) {
  for (const Camera& camera : {test::perspective_camera(), test::equidistant_camera()}) {
    const Filmed filmed = film(camera);
    const CalibrationResult result = calibrate(filmed.stated, filmed.frames);
    EXPECT_THAT(result.corrections, IsEmpty());
    EXPECT_THAT(result.warnings, IsEmpty());
    EXPECT_EQ(result.rig.cameras[0].model.pinhole().fx, camera.model.pinhole().fx);
  }
}

TEST(CameraRefinement, LeavesARightCameraAloneThatFilmsFromOnePlace) {
  // Each tag's corners err the same in all frames, so that frames that are held out cannot tell this from a
  // lens.
  int corrected = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Filmed filmed = film(test::perspective_camera(), 0.0, 60);
    RandomStream random(60, seed);
    const std::size_t place = 5 * (seed - 1);
    for (std::size_t i = 0; i < filmed.truth.T_world_rig.size(); ++i) {
      const Eigen::Vector3d step{0.02 * random.normal(), 0.02 * random.normal(), 0.02 * random.normal()};
      filmed.truth.T_world_rig[i] = filmed.truth.T_world_rig[place] * by(step.x(), step.y(), step.z());
    }
    filmed.frames = test::exact_detections(filmed.truth);
    test::add_edge_biases(filmed.frames, 0.05, -0.45, random);
    test::add_edge_noise(filmed.frames, 0.02, -0.45, random);
    if (!calibrate(filmed.stated, filmed.frames).corrections.empty()) ++corrected;
  }
  EXPECT_LE(corrected, 1);
}

TEST(CameraRefinement, FindsAWrongFocalLengthInFewFrames) {
  Filmed filmed = film(test::perspective_camera(), 0.1, 50);
  scale_focal_length(filmed.stated.rig.cameras[0], 1.04);
  const CalibrationResult result = calibrate(filmed.stated, filmed.frames);
  const CameraCorrection* focal = correction(result, "focal length");
  ASSERT_NE(focal, nullptr);
  EXPECT_NEAR(focal->value, 1.0 / 1.04 - 1.0, 5.0 * focal->sigma);
  EXPECT_LT(focal->sigma, 0.006);  // a fifth of what was known before
}

TEST(CameraRefinement, SaysWhyACameraThatWasToBeRefinedStays) {
  const Filmed filmed = film(test::perspective_camera());
  const CalibrationResult result =
      calibrate(filmed.stated, filmed.frames, {.intrinsics = Intrinsics::kRefine});
  EXPECT_THAT(result.corrections, IsEmpty());
  EXPECT_THAT(result.warnings,
              ::testing::ElementsAre(HasSubstr("the intrinsics stay as the camera file has them: ")));
}

TEST(CameraRefinement, KeepsTheCameraWhereToldTo) {
  Filmed filmed = film(test::perspective_camera());
  scale_focal_length(filmed.stated.rig.cameras[0], 1.03);
  const CalibrationResult result = calibrate(filmed.stated, filmed.frames, {.intrinsics = Intrinsics::kKeep});
  EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("It is kept, as was asked for")));
  EXPECT_THAT(result.warnings, Not(::testing::Contains(HasSubstr("too few frames tell"))))
      << "frames do tell";
  EXPECT_THAT(result.corrections, IsEmpty());
  EXPECT_EQ(result.rig.cameras[0].model.pinhole().fx, filmed.stated.rig.cameras[0].model.pinhole().fx);
}

TEST(CameraRefinement, FindsHowFarEdgesLieInside) {
  Filmed filmed = film(test::perspective_camera(), 0.05);
  constexpr double kInward_px = 0.2;
  move_edges_inward(kInward_px, filmed.frames);
  const CalibrationResult without =
      calibrate(filmed.stated, filmed.frames, {.intrinsics = Intrinsics::kKeep});
  const CalibrationResult result =
      calibrate(filmed.stated, filmed.frames, {.edge_offset_sigma_px = 0.2, .intrinsics = Intrinsics::kKeep});
  const CameraCorrection* offset = correction(result, "edge offset");
  ASSERT_NE(offset, nullptr);
  EXPECT_NEAR(offset->value, kInward_px, 5.0 * offset->sigma);
  const auto told = testing::Contains(testing::HasSubstr("more than is usual (sigma"));
  EXPECT_THAT(result.warnings, testing::Not(told));
  const CalibrationResult surprised =
      calibrate(filmed.stated, filmed.frames,
                {.edge_offset_sigma_px = 0.3 * kInward_px, .intrinsics = Intrinsics::kKeep});
  EXPECT_THAT(surprised.warnings, told);
  const auto error = [&](const TagMap& map) {
    double squares = 0.0;
    for (const MapTag& tag : map.tags)
      squares += (tag.T_map_tag.translation() -
                  test::T_origin_tag(filmed.truth.map, result.held_tag, tag.key).translation())
                     .squaredNorm();
    return std::sqrt(squares / static_cast<double>(map.tags.size()));
  };
  EXPECT_LT(error(result.map), 0.4 * error(without.map));
}

/// A file without distortion, of a lens that has much; and of about any focal length.
TEST(CameraRefinement, FindsALensThatTheFileLacks) {
  Camera camera = test::perspective_camera();
  const Pinhole pinhole = camera.model.pinhole();
  camera.model = CameraModel(pinhole, RadtanDistortion({-0.28, 0.09, 5e-4, -3e-4}));
  for (const double factor : {1.0, 1.15, 2.0, 0.5}) {
    const double focal_px = factor * pinhole.fx;
    Filmed filmed = film(camera, 0.05);
    filmed.stated.rig.cameras[0].model =
        CameraModel({focal_px, focal_px, 500.0, 400.0}, RadtanDistortion({0.0, 0.0, 0.0, 0.0}));
    const CalibrationResult result = calibrate(filmed.stated, filmed.frames);
    EXPECT_EQ(result.map.tags.size(), 14u) << factor;
    EXPECT_THAT(result.warnings, ::testing::ElementsAre(HasSubstr("the camera file does not fit")));
    expect_truth(filmed.truth, result.map, result.held_tag, 0.01, 0.005);
    const CameraCorrection* k1 = correction(result, "k1");
    ASSERT_NE(k1, nullptr);
    EXPECT_NEAR(k1->value, -0.28, 5.0 * k1->sigma);
    EXPECT_LT(k1->sigma, 0.005);
    const CameraCorrection* focal = correction(result, "focal length");
    ASSERT_NE(focal, nullptr);
    EXPECT_NEAR(focal->value, pinhole.fx / focal_px - 1.0, 5.0 * focal->sigma);
    EXPECT_LT(focal->sigma, 0.005);
  }
}

TEST(CameraRefinement, FindsALensForAFileWithoutAModel) {
  Camera camera = test::perspective_camera();
  camera.model = CameraModel(camera.model.pinhole(), RadtanDistortion({-0.28, 0.09, 5e-4, -3e-4}));
  Filmed filmed = film(camera, 0.05);
  filmed.stated.rig.cameras[0].model = CameraModel(camera.model.pinhole(), NoDistortion{});
  const CalibrationResult result = calibrate(filmed.stated, filmed.frames);
  EXPECT_EQ(result.map.tags.size(), 14u);
  expect_truth(filmed.truth, result.map, result.held_tag, 0.01, 0.005);
  EXPECT_EQ(result.rig.cameras[0].model.distortion_name(), "radtan");
  ASSERT_NE(correction(result, "k1"), nullptr);
}

TEST(CameraRefinement, WarnsOfALensThatItIsToKeep) {
  Camera camera = test::perspective_camera();
  camera.model = CameraModel(camera.model.pinhole(), RadtanDistortion({-0.28, 0.09, 5e-4, -3e-4}));
  Filmed filmed = film(camera, 0.05);
  filmed.stated.rig.cameras[0].model =
      CameraModel(camera.model.pinhole(), RadtanDistortion({-0.15, 0.0, 0.0, 0.0}));
  const CalibrationResult result = calibrate(filmed.stated, filmed.frames, {.intrinsics = Intrinsics::kKeep});
  EXPECT_THAT(result.warnings, ::testing::Contains(::testing::AllOf(HasSubstr("the tags do not look square"),
                                                                    HasSubstr("as was asked for"))));
  EXPECT_THAT(result.corrections, IsEmpty());
}

TEST(CameraRefinement, FindsWhereTheSecondCameraSits) {
  Filmed filmed = film_with_two_cameras(by(-0.12, 0.0, 0.0));
  filmed.stated.rig.cameras[1].T_this_previous = by(-0.125, 0.002, 0.0);
  const CalibrationResult result =
      calibrate(filmed.stated, filmed.frames, {.intrinsics = Intrinsics::kKeep, .refine_extrinsics = true});
  ASSERT_NE(correction(result, "translation x"), nullptr);
  const Pose error = result.rig.T_camera_rig(1) * filmed.truth.rig.T_camera_rig(1).inverse();
  EXPECT_LT(error.translation().norm(), 1e-3);
  EXPECT_LT(error.log().tail<3>().norm(), 1e-3);
  EXPECT_THAT(result.warnings, ::testing::ElementsAre(::testing::AllOf(HasSubstr("with other places, "),
                                                                       Not(HasSubstr("intrinsics")))));
}

TEST(CameraRefinement, SaysThatTheRigDoesNotFit) {
  Filmed filmed = film_with_two_cameras(by(-0.12, 0.0, 0.0));
  EXPECT_THAT(calibrate(filmed.stated, filmed.frames).warnings, IsEmpty());
  filmed.stated.rig.cameras[1].T_this_previous = by(-0.132, 0.0, 0.0);
  const CalibrationResult result = calibrate(filmed.stated, filmed.frames);
  EXPECT_THAT(result.warnings, ::testing::Contains(::testing::AllOf(
                                   HasSubstr("the rig of the camera file does not fit"),
                                   HasSubstr("cam1 0.012 m"), HasSubstr("let the extrinsics be refined"))));
}

/// One camera's file is of another lens; the other's is right, and stays.
TEST(CameraRefinement, FindsTheLensOfOneOfTwoCameras) {
  Filmed filmed = film_with_two_cameras(by(-0.12, 0.0, 0.0));
  const CameraModel right = filmed.truth.rig.cameras[1].model;
  filmed.stated.rig.cameras[1].model =
      CameraModel({2.0 * right.pinhole().fx, 2.0 * right.pinhole().fy, 500.0, 400.0},
                  RadtanDistortion({0.3, 0.0, 0.0, 0.0}));
  const CalibrationResult result = calibrate(filmed.stated, filmed.frames);
  EXPECT_EQ(result.map.tags.size(), 14u);
  expect_truth(filmed.truth, result.map, result.held_tag, 0.02, 0.01);
  EXPECT_NEAR(result.rig.cameras[1].model.pinhole().fx, right.pinhole().fx, 0.01 * right.pinhole().fx);
  for (const CameraCorrection& one : result.corrections) EXPECT_EQ(one.camera, "cam1") << one.parameter;
}

/// A few percent of a focal length, far from the tags, move a camera by more than its rig is known by.
TEST(CameraRefinement, DoesNotBlameTheRigForALens) {
  Filmed filmed = film_with_two_cameras(by(-0.12, 0.0, 0.0));
  scale_focal_length(filmed.stated.rig.cameras[1], 1.05);
  const CalibrationResult result = calibrate(filmed.stated, filmed.frames);
  EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("cam1: focal length -4.")));
  EXPECT_THAT(result.warnings, ::testing::Each(::testing::Not(HasSubstr("T_cn_cnm1"))));
  EXPECT_EQ(result.map.tags.size(), 14u);
}

TEST(CameraRefinement, MakesNoMapByARigInMillimetresOrTheInverse) {
  const Pose turned(Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY())),
                    Eigen::Vector3d(-0.12, 0.03, 0.0));
  Filmed filmed = film_with_two_cameras(turned);
  const auto error_with = [&](const Pose& stated) {
    filmed.stated.rig.cameras[1].T_this_previous = stated;
    return test::error_of(ErrorKind::kNoResult, [&] { calibrate(filmed.stated, filmed.frames); });
  };
  EXPECT_THAT(error_with({turned.rotation(), 1000.0 * turned.translation()}),
              ::testing::AllOf(HasSubstr("cam0 to cam1"), HasSubstr("look like millimetres")));
  EXPECT_THAT(error_with({turned.rotation(), 100.0 * turned.translation()}),
              HasSubstr("look like centimetres"));
  EXPECT_THAT(error_with(turned.inverse()), HasSubstr("looks like the inverse"));
  EXPECT_THAT(error_with(by(0.9, 0.0, 0.0) * turned), HasSubstr("is it of this rig"));
}

}  // namespace
}  // namespace apriltrack
