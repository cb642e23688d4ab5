#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "apriltrack/camera/camera_formats.h"
#include "support/shared_data.h"

namespace apriltrack::test {

/// Reads texts as camera files.
class ForeignCameraFile : public ::testing::Test {
 protected:
  CameraFile read(const std::string& name, const std::string& text) {
    const auto path = temporary_folder() / name;
    std::ofstream(path) << text;
    return read_camera_file(path, [&](LogLevel, std::string_view told) { warnings_.emplace_back(told); });
  }
  void read_here(const std::string& name, const std::string& text) { file_ = read(name, text); }
  const Camera& camera_of(const std::string& name, const std::string& text) {
    file_ = read(name, text);
    return file_.rig.cameras.front();
  }
  /// fx fy cx cy, coefficients, width, height.
  std::vector<double> numbers_of(const std::string& name, const std::string& text) {
    return numbers(camera_of(name, text));
  }
  static std::vector<double> numbers(const Camera& camera) {
    const Pinhole& lens = camera.model.pinhole();
    std::vector<double> all = {lens.fx, lens.fy, lens.cx, lens.cy};
    for (const double k :
         std::visit([](const auto& one) { return one.coefficients(); }, camera.model.distortion()))
      all.push_back(k);
    all.push_back(camera.width);
    all.push_back(camera.height);
    return all;
  }

  /// "extrinsics of cam0: T_BS" of each loss.
  std::vector<std::string> lost() const {
    std::vector<std::string> words;
    for (const ConversionLoss& loss : file_.lost)
      words.push_back(std::string(to_string(loss.kind)) + " of " + loss.which.at(0) + ": " + loss.value);
    return words;
  }

  CameraFile file_;
  std::vector<std::string> warnings_;
};

}  // namespace apriltrack::test
