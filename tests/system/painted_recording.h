#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/image/image.h"
#include "program.h"

namespace apriltrack::test {

struct PaintedTag {
  std::string family;
  int id = 0;
  int column = 0;  ///< Of places side by side; three fit into a picture.
};

/// A grey picture of 480 x 160 pixels with tags of 64 px on white paper; a pixel shows the mean of 2 x 2
/// pixels' area.
GrayImage paint(const std::vector<PaintedTag>& tags, int width = 480);

/// As a camera sees it that goes past, two pixels from frame to frame.
GrayImage seen_in_passing(const GrayImage& picture, int frame);

/// Of such pictures.
inline constexpr const char* kPaintedCamera =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [500.0, 500.0, 239.5, 79.5]\n  distortion_model: none\n"
    "  distortion_coeffs: []\n  resolution: [480, 160]\n  exposure_time: 0.01\n  response: linear\n";

inline const std::vector<PaintedTag> kThreeTags = {
    {"tag36h11", 1, 0}, {"tag36h11", 2, 1}, {"tag36h11", 3, 2}};

/// A recording of painted tags, which `doctor` looks at.
class Doctor : public ::testing::Test {
 protected:
  void SetUp() override;

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// `count` more frames, at 10 Hz, by a camera that goes past.
  void film(int count, const GrayImage& picture);

  ProgramRun look(const std::vector<std::string>& more = {}) const;

  std::filesystem::path folder_;
  int num_frames_ = 0;
};

}  // namespace apriltrack::test
