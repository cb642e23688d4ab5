#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "apriltrack/base/error.h"
#include "apriltrack/base/random.h"
#include "apriltrack/tags/tag_map.h"
#include "support/shared_data.h"

namespace apriltrack::test {

/// Without the wait for the disk of an atomic write: the tests below write thousands of files.
inline std::filesystem::path file_with(const std::string& text) {
  const auto path = test::temporary_folder() / "lab.yaml";
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

inline TagMap map_from(const std::string& text) {
  return read_tag_map(file_with(text));
}

inline std::string complaint_about(const std::string& text) {
  const auto path = file_with(text);
  try {
    read_tag_map(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput) << error.what();
    return error.what();
  }
  return "no complaint";
}

/// Lines 1 to 3 of a map file; tags begin on line 5.
inline const std::string kHead = "apriltrack_map: 1\nframe: world\ndefault_family: tag36h11\ntags:\n";
inline const std::string kPose =
    "    pose:\n      position: {x: 1.5, y: -2, z: 0.25}\n      orientation: {x: 0.5, y: 0.5, z: -0.5, w: "
    "0.5}\n";

inline std::string one_tag(const std::string& id, const std::string& size, const std::string& rest = kPose) {
  return kHead + "  - id: " + id + "\n    size: " + size + "\n" + rest;
}

inline std::string with_orientation(const std::string& orientation) {
  return one_tag("7", "0.16",
                 "    pose:\n      position: {x: 0, y: 0, z: 0}\n      orientation: " + orientation + "\n");
}

inline std::string with_position(const std::string& position) {
  return one_tag(
      "7", "0.16",
      "    pose:\n      position: " + position + "\n      orientation: {x: 0, y: 0, z: 0, w: 1}\n");
}

inline void expect_same(const TagMap& a, const TagMap& b) {
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.default_family, b.default_family);
  EXPECT_EQ(a.provenance, b.provenance);
  EXPECT_EQ(a.extensions, b.extensions);
  ASSERT_EQ(a.tags.size(), b.tags.size());
  for (std::size_t i = 0; i < a.tags.size(); ++i) {
    const MapTag& p = a.tags[i];
    const MapTag& q = b.tags[i];
    EXPECT_EQ(p.key, q.key);
    EXPECT_EQ(p.size_m, q.size_m);
    // To the last bit, the sign of zero included.
    for (int k = 0; k < 3; ++k) {
      const double x = p.T_map_tag.translation()[k];
      EXPECT_EQ(x, q.T_map_tag.translation()[k]);
      EXPECT_EQ(std::signbit(x), std::signbit(q.T_map_tag.translation()[k]));
    }
    EXPECT_EQ(p.T_map_tag.rotation().coeffs(), q.T_map_tag.rotation().coeffs()) << to_string(p.key);
    EXPECT_EQ(p.covariance, q.covariance);
    ASSERT_EQ(p.statistics.has_value(), q.statistics.has_value());
    if (p.statistics) {
      EXPECT_EQ(p.statistics->views, q.statistics->views);
      EXPECT_EQ(p.statistics->residual_rms_px, q.statistics->residual_rms_px);
      EXPECT_EQ(p.statistics->flags, q.statistics->flags);
    }
    EXPECT_EQ(p.extensions, q.extensions);
  }
}

inline Matrix6d random_covariance(RandomStream& random) {
  Matrix6d root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = random.normal();
  const Vector6d scale = (Vector6d() << 1e-3, 2e-3, 1e-2, 1e-2, 3e-2, 1e-4).finished();
  return scale.asDiagonal() * (root * root.transpose()) * scale.asDiagonal();
}

inline MapTag random_tag(RandomStream& random, int id) {
  MapTag tag;
  tag.key = {id % 3 == 0 ? "tagStandard41h12" : "tag36h11", id};
  tag.size_m = random.uniform(1e-3, 2.0);
  const Eigen::Vector4d q{random.normal(), random.normal(), random.normal(), random.normal()};
  const double magnitude = std::pow(10.0, random.uniform(-12.0, 6.0));
  tag.T_map_tag = Pose(
      Eigen::Quaterniond(q),
      magnitude * Eigen::Vector3d{random.normal(), random.normal(), id % 7 == 0 ? -0.0 : random.normal()});
  if (id % 2 == 0) tag.covariance = random_covariance(random);
  if (id % 5 == 0) tag.covariance = Matrix6d::Zero();
  if (id % 4 == 1) tag.statistics = TagStatistics{id, random.uniform(), {"weak", "seen once: \"yes\""}};
  return tag;
}

}  // namespace apriltrack::test
