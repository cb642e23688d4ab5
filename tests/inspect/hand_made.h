#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "apriltrack/inspect/findings.h"
#include "apriltrack/inspect/recording_summary.h"
#include "apriltrack/inspect/tag_summary.h"
#include "checks.h"

// InspectionFacts by hand, whose faults are known because they were put there.

namespace apriltrack {

inline TagKey tag36(int id) {
  return {"tag36h11", id};
}

inline SeenTag seen(int id, double edge_px = 60.0, double blur_px = 0.5) {
  return {.tag = tag36(id), .edge_px = edge_px, .margin = 80.0, .blur_px = blur_px};
}

/// A good frame at 30 Hz that shows these tags.
inline FrameFacts frame(int number, const std::vector<int>& ids) {
  FrameFacts facts{.name = std::to_string(number) + ".png",
                   .time = {1'000'000'000 + number * std::int64_t{33'333'333}},
                   .width = 640,
                   .height = 480};
  for (const int id : ids) {
    facts.tags.push_back(seen(id));
    const Eigen::Vector2d corner(20.0 + 7.0 * number + 3.0 * id, 200.0 + 3.0 * id);  // the camera goes past
    facts.tags.back().corners_px = {corner, corner + Eigen::Vector2d(60.0, 0.0),
                                    corner + Eigen::Vector2d(60.0, -60.0),
                                    corner + Eigen::Vector2d(0.0, -60.0)};
  }
  return facts;
}

inline Camera good_camera() {
  return {.name = "cam0",
          .model = CameraModel(Pinhole{500, 501, 320.5, 238.5}, NoDistortion{}),
          .width = 640,
          .height = 480,
          .exposure_s = 0.01};
}

/// Frames from number 0, as good as can be.
inline RecordingFacts recording(const std::vector<std::vector<int>>& ids_of_frames) {
  RecordingFacts facts{.input = "film", .camera_name = "cam0", .camera = good_camera(), .sampled = 20};
  for (const auto& ids : ids_of_frames)
    facts.frames.push_back(frame(static_cast<int>(facts.frames.size()), ids));
  return facts;
}

inline InspectionFacts facts_of(const RecordingFacts& film) {
  InspectionFacts facts{.families = {"tag36h11"}, .recordings = {film}};
  for (const FrameFacts& one : film.frames) {
    std::vector<TagKey> tags;
    for (const SeenTag& tag : one.tags) tags.push_back(tag.tag);
    std::ranges::sort(tags);
    const auto repeated = std::ranges::unique(tags);
    tags.erase(repeated.begin(), repeated.end());
    if (!tags.empty()) facts.places.push_back(tags);
  }
  return facts;
}

/// `count` frames that all show the same tags.
inline std::vector<std::vector<int>> frames_of(std::size_t count, const std::vector<int>& ids) {
  return std::vector<std::vector<int>>(count, ids);
}

inline std::vector<std::vector<int>> operator+(std::vector<std::vector<int>> a,
                                               const std::vector<std::vector<int>>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

inline std::vector<std::string> abouts(const std::vector<RecordingFinding>& findings) {
  std::vector<std::string> words;
  for (const RecordingFinding& finding : findings) words.push_back(finding.about);
  return words;
}

}  // namespace apriltrack
