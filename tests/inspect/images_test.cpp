// What images, times, camera and blur lead to.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "hand_made.h"

namespace apriltrack {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(InspectImages, OfAGoodFilmNothingIsFound) {
  const RecordingFacts film = recording(frames_of(30, {1, 2}));
  EXPECT_THAT(check_images(film), IsEmpty());
  EXPECT_THAT(check_camera(film), IsEmpty());
  EXPECT_THAT(check_blur(film), IsEmpty());
}

/// 30 frames that are read and 1, or 2, that are not: one in twenty is between them.
TEST(InspectImages, ManyThatCannotBeReadAreAWarning) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  for (const auto& [unreadable, severity] :
       {std::pair(1, FindingSeverity::kNote), {2, FindingSeverity::kWarning}}) {
    film.unreadable = static_cast<std::size_t>(unreadable);
    const auto findings = check_images(film);
    ASSERT_THAT(abouts(findings), ElementsAre("unreadable"));
    EXPECT_EQ(findings[0].severity, severity) << unreadable;
  }
}

TEST(InspectImages, SizesThatDifferAreCounted) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  for (const std::size_t i : {0u, 7u}) film.frames[i].width = 320;
  const auto findings = check_images(film);
  ASSERT_THAT(abouts(findings), ElementsAre("mixed_resolutions"));
  EXPECT_THAT(findings[0].text, HasSubstr("images of 2 sizes (28 of 640 x 480, 2 of 320 x 480)"));
}

TEST(InspectImages, OneCameraIsOfOneSize) {
  RecordingFacts small = recording(frames_of(30, {1, 2})), large = small;
  small.input = "clip";
  for (FrameFacts& one : small.frames) one.width = 320;
  small.camera.reset();
  const InspectionFacts two{.families = {"tag36h11"}, .recordings = {large, small}};
  const auto findings = check_sizes(two);
  ASSERT_THAT(abouts(findings), ElementsAre("camera_sizes"));
  EXPECT_EQ(findings[0].severity, FindingSeverity::kStops);
  EXPECT_THAT(findings[0].text, HasSubstr("film is of 640 x 480 pixels and clip of 320 x 480"));
  EXPECT_THAT(check_sizes({.families = {}, .recordings = {large, large}}), IsEmpty());
  small.camera = large.camera;
  EXPECT_THAT(abouts(check_sizes({.families = {}, .recordings = {large, small}})),
              ElementsAre("camera_sizes"));
  EXPECT_THAT(abouts(inspection_findings({.families = {"tag36h11"}, .recordings = {large, small}})),
              AllOf(Contains("camera_sizes"), Not(Contains("camera_resolution"))));
  small.camera_name = "cam1";
  EXPECT_THAT(check_sizes({.families = {}, .recordings = {large, small}}), IsEmpty());
}

TEST(InspectImages, TimesHaveARateAndGaps) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  film.frames.erase(film.frames.begin() + 10, film.frames.begin() + 14);  // 5 intervals in one
  film.frames.erase(film.frames.begin() + 20);  // twice an interval: a frame dropped here and there
  const FrameTimes times = frame_times(film.frames);
  EXPECT_NEAR(*times.rate_hz, 30.0, 1e-4);
  EXPECT_EQ(times.gaps, 1u);
  EXPECT_NEAR(times.longest_gap_s, 5.0 / 30.0, 1e-6);
  ASSERT_THAT(abouts(check_images(film)), ElementsAre("time_gaps"));
}

TEST(InspectImages, AClockThatGoesBackIsTold) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  film.frames[9].time = film.frames[8].time;
  film.frames[20].time.ns -= 100'000'000;
  const auto findings = check_images(film);
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0].about, "times_not_forward");
  EXPECT_THAT(findings[0].text, HasSubstr("2 frames"));
}

TEST(InspectImages, OneFrameHasNoRate) {
  EXPECT_FALSE(frame_times(recording({{1}}).frames).rate_hz);
  EXPECT_EQ(frame_times({}).gaps, 0u);
}

TEST(InspectImages, BlankDarkAndWhiteFramesAreTold) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  film.frames[0].is_blank = true;
  film.frames[0].bright_level = 0;
  for (const std::size_t i : {1u, 2u, 3u, 4u}) film.frames[i].bright_level = 39;
  for (const std::size_t i : {5u, 6u, 7u, 8u, 9u}) film.frames[i].tags[1].is_clipped = true;
  film.frames[10].white_share = 0.9;  // a bright wall behind tags that are not clipped
  const auto findings = check_images(film);
  ASSERT_THAT(abouts(findings), ElementsAre("blank_frames", "dark_frames", "white_frames"));
  EXPECT_THAT(findings[0].text, HasSubstr("1 of 30"));
  EXPECT_THAT(findings[1].text, HasSubstr("4 of 30"));
  EXPECT_THAT(findings[2].text, HasSubstr("5 of 30"));
}

TEST(InspectImages, AWhiteFrameWithoutTagsIsOverexposed) {
  RecordingFacts film = recording(frames_of(30, {}));
  for (FrameFacts& one : film.frames) one.white_share = 0.3;
  EXPECT_THAT(abouts(check_images(film)), ElementsAre("white_frames"));
}

TEST(InspectImages, AFewDarkOnesAreNoWordOnTheFilm) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  for (const std::size_t i : {1u, 2u, 3u}) film.frames[i].bright_level = 10;
  EXPECT_THAT(check_images(film), IsEmpty());
}

TEST(InspectCamera, AnotherResolutionStopsAndNamesBoth) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  film.camera->width = 1280;
  film.camera->height = 960;
  film.camera->model = CameraModel(Pinhole{1000, 1000, 640, 480}, NoDistortion{});
  const auto findings = check_camera(film);
  ASSERT_THAT(abouts(findings), ElementsAre("camera_resolution"));
  EXPECT_EQ(findings[0].severity, FindingSeverity::kStops);
  EXPECT_THAT(findings[0].text, HasSubstr("640 x 480"));
  EXPECT_THAT(findings[0].text, HasSubstr("1280 x 960"));
  film.frames[3].width = 1280;
  film.frames[3].height = 960;
  const auto of_mixed = check_camera(film);
  ASSERT_THAT(abouts(of_mixed), ElementsAre("camera_resolution"));
  EXPECT_EQ(of_mixed[0].severity, FindingSeverity::kWarning);
  EXPECT_THAT(of_mixed[0].text, HasSubstr("most images are 640 x 480 pixels"));
  for (std::size_t i = 0; i < 16; ++i) {
    film.frames[i].width = 1280;
    film.frames[i].height = 960;
  }
  EXPECT_THAT(check_camera(film), IsEmpty()) << "most fit; check_images tells of the others";
}

TEST(InspectCamera, OddIntrinsicsAreTold) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  film.camera->model = CameraModel(Pinhole{500, 500, 160, 120}, NoDistortion{});
  EXPECT_THAT(abouts(check_camera(film)), ElementsAre("principal_point"));
  film.camera->model = CameraModel(Pinhole{500, 667, 320, 240}, NoDistortion{});
  const auto findings = check_camera(film);
  ASSERT_THAT(abouts(findings), ElementsAre("focal_lengths"));
  EXPECT_THAT(findings[0].text, HasSubstr("fx / fy = 0.750"));
}

TEST(InspectCamera, WhatIsNotToldIsANote) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  film.camera->exposure_s.reset();
  const auto untold = check_camera(film);
  ASSERT_THAT(abouts(untold), ElementsAre("no_exposure"));
  EXPECT_EQ(untold[0].severity, FindingSeverity::kNote);
  film.frames[0].tells_exposure = true;
  EXPECT_THAT(check_camera(film), IsEmpty());
  film.camera.reset();
  EXPECT_THAT(abouts(check_camera(film)), ElementsAre("no_camera"));
}

TEST(InspectCamera, ARollingShutterIsAWarning) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  film.camera->line_delay_s = 3e-5;
  EXPECT_THAT(abouts(check_camera(film)), ElementsAre("rolling_shutter"));
}

TEST(InspectBlur, IsCountedByFramesAndWarnedOf) {
  RecordingFacts film = recording(frames_of(10, {1, 2, 3}));
  for (const std::size_t i : {0u, 1u}) film.frames[i].tags[0].blur_px = 20.0;  // one tag of three: the median
  for (const std::size_t i : {2u, 3u, 4u})
    for (SeenTag& tag : film.frames[i].tags) tag.blur_px = 6.0;
  for (SeenTag& tag : film.frames[5].tags) tag.blur_px = 3.0;
  for (SeenTag& tag : film.frames[6].tags) tag.blur_px.reset();
  const BlurCounts counts = count_blur(film.frames);
  EXPECT_EQ(counts.sharp, 5u);
  EXPECT_EQ(counts.soft, 1u);
  EXPECT_EQ(counts.blurred, 3u);
  EXPECT_EQ(*counts.worst_px, 6.0);
  const auto findings = check_blur(film);
  ASSERT_THAT(abouts(findings), ElementsAre("blur"));
  EXPECT_THAT(findings[0].text, HasSubstr("in 33 % of the frames"));
}

TEST(InspectBlur, FramesWithoutTagsCountBetweenFramesWith) {
  const auto ids = frames_of(50, {}) + frames_of(10, {1, 2}) + frames_of(6, {}) + frames_of(10, {1, 2}) +
                   frames_of(50, {});
  const RecordingFacts film = recording(ids);
  EXPECT_EQ(count_blur(film.frames).unread, 6u);
  ASSERT_THAT(abouts(check_blur(film)), ElementsAre("frames_without_tags"));
}

TEST(InspectVerdict, IsReadyWhereNothingIsWrong) {
  const auto findings = inspection_findings(facts_of(recording(frames_of(30, {1, 2}))));
  EXPECT_THAT(findings, IsEmpty());
  EXPECT_EQ(verdict_of(findings, true).readiness, CalibrationReadiness::kReady);
  EXPECT_EQ(verdict_of(findings, true).text, "ready to calibrate");
}

TEST(InspectVerdict, CountsWarningsAndNotNotes) {
  RecordingFacts film = recording(frames_of(30, {1, 2}));
  film.camera->exposure_s.reset();
  EXPECT_EQ(verdict_of(inspection_findings(facts_of(film)), true).readiness, CalibrationReadiness::kReady);
  film.frames[3].is_blank = true;
  const auto findings = inspection_findings(facts_of(film));
  EXPECT_THAT(abouts(findings), ElementsAre("blank_frames", "no_exposure")) << "warnings first";
  EXPECT_EQ(verdict_of(findings, true).readiness, CalibrationReadiness::kReadyWithWarnings);
  EXPECT_THAT(verdict_of(findings, true).text, HasSubstr("1 warning above"));
}

TEST(InspectVerdict, NamesWhatStops) {
  RecordingFacts film = recording(frames_of(30, {7}));
  film.frames[3].is_blank = true;
  const auto findings = inspection_findings(facts_of(film));
  EXPECT_THAT(abouts(findings), ElementsAre("none_together", "blank_frames"));
  const CalibrationVerdict verdict = verdict_of(findings, true);
  EXPECT_EQ(verdict.readiness, CalibrationReadiness::kNotReady);
  EXPECT_THAT(verdict.text, HasSubstr("will not calibrate: only one tag was seen"));
  EXPECT_THAT(verdict.text, HasSubstr("it can be tracked"));
}

TEST(InspectVerdict, OfSeveralRecordingsSaysWhich) {
  InspectionFacts facts = facts_of(recording(frames_of(30, {1, 2})));
  facts.recordings.push_back(facts.recordings.front());
  facts.recordings.back().input = "second";
  facts.recordings.back().frames[3].is_blank = true;
  const auto findings = inspection_findings(facts);
  ASSERT_THAT(abouts(findings), ElementsAre("blank_frames"));
  EXPECT_THAT(findings[0].text, ::testing::StartsWith("second: 1 of 30"));
}

/// Views of a square all over the picture by a lens that bends lines.
TEST(InspectLens, OneThatBendsWhatTheFileHasStraightIsToldOf) {
  Camera bending = good_camera();
  bending.model = CameraModel(bending.model.pinhole(), RadtanDistortion({-0.3, 0.09, 0.0, 0.0}));
  RecordingFacts film = recording(frames_of(150, {1}));
  for (std::size_t i = 0; i < film.frames.size(); ++i) {
    const double turn = 0.7 * static_cast<double>(i), tilt = 0.8 * std::sin(1.3 * static_cast<double>(i));
    const double far = std::sqrt(static_cast<double>(i) / 150.0);  // evenly over the picture
    const Eigen::Vector3d centre(0.4 * far * std::cos(1.7 * turn), 0.3 * far * std::sin(1.7 * turn), 0.7);
    const Eigen::Matrix3d R = (Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()))
                                  .toRotationMatrix();
    const Eigen::Vector3d ends[] = {{-0.1, 0.1, 0.0}, {0.1, 0.1, 0.0}, {0.1, -0.1, 0.0}, {-0.1, -0.1, 0.0}};
    for (std::size_t k = 0; k < 4; ++k)
      film.frames[i].tags[0].corners_px[k] = bending.model.project(centre + R * ends[k]).value();
  }
  film.camera = bending;
  EXPECT_THAT(check_lens(film), IsEmpty());
  film.camera = good_camera();
  film.camera->model = CameraModel(film.camera->model.pinhole(), RadtanDistortion({0.0, 0.0, 0.0, 0.0}));
  const auto findings = check_lens(film);
  ASSERT_THAT(abouts(findings), ElementsAre("lens"));
  EXPECT_THAT(findings[0].text, HasSubstr("distortion radtan [-0.3"));
  // Pictures of another size are not of this file's lens, and calibrate leaves them out.
  for (FrameFacts& frame : film.frames) frame.width *= 2;
  EXPECT_THAT(check_lens(film), IsEmpty());
}

}  // namespace
}  // namespace apriltrack
