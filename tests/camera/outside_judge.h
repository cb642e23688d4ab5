#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/io/numbers.h"
#include "support/judges.h"
#include "support/shared_data.h"

namespace apriltrack::test {

/// What a shell command says on stdout; nullopt where it fails.
inline std::optional<std::string> output_of(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  std::string output;
  char buffer[4096];
  for (std::size_t size = 0; (size = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
    output.append(buffer, size);
  return ::pclose(pipe) == 0 ? std::optional(output) : std::nullopt;
}

inline constexpr double kMaxJudgedError_px = 1e-6;

/// Runs one of the scripts beside this file, which needs these modules.
inline std::string script(const std::string& name, const std::string& modules) {
  return python_with(modules) + " " + source_path("tests/camera/" + name).string() + " ";
}

/// Words of the line that begins with `key`.
inline std::vector<std::string> line_of(const std::string& output, const std::string& key) {
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string first;
    words >> first;
    if (first == key) return {std::istream_iterator<std::string>(words), {}};
  }
  return {};
}

inline std::vector<double> numbers_of(const std::vector<std::string>& words) {
  std::vector<double> numbers;
  for (const std::string& word : words) numbers.push_back(parse_double(word).value());
  return numbers;
}

/// Ours.
inline std::vector<Eigen::Vector2d> projected(const Camera& camera,
                                              const std::vector<Eigen::Vector3d>& points) {
  std::vector<Eigen::Vector2d> pixels;
  for (const Eigen::Vector3d& point : points) pixels.push_back(camera.model.project(point).value());
  return pixels;
}

/// Of 1000 pixels and more.
inline void expect_near(const std::vector<Eigen::Vector2d>& pixels,
                        const std::vector<Eigen::Vector2d>& expected) {
  ASSERT_EQ(pixels.size(), expected.size());
  ASSERT_GE(pixels.size(), 1000U);
  double largest = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    largest = std::max(largest, (pixels[i] - expected[i]).norm());
  EXPECT_LE(largest, kMaxJudgedError_px);
}

inline bool is_fisheye(const Camera& camera) {
  return camera.model.distortion_name() == "equidistant";
}

}  // namespace apriltrack::test
