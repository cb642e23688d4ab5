#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/detect/left_out_tags.h"
#include "apriltrack/detect/odd_pictures.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_key.h"
#include "camera_response.h"

namespace apriltrack::app {

// What `doctor` sees of a recording before it judges: plain facts, so that judgements are tested without
// images.

/// One reading of a tag in one frame.
struct SeenTag {
  TagKey tag;
  double edge_px = 0.0;                          ///< Mean of its four edges.
  double margin = 0.0;                           ///< Decision margin in grey levels.
  int corrected_bits = 0;                        ///< Of its code.
  std::optional<double> blur_px = std::nullopt;  ///< As motion_of_blur_px; none where edges were hidden.
  bool is_clipped = false;                       ///< Its paper is at 255.
  bool is_at_border = false;                     ///< A corner lies in the image's outermost 3 %.
  std::array<Eigen::Vector2d, kNumCorners> corners_px = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                                         Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
};

/// One frame that could be read.
struct FrameFacts {
  std::string name;
  Timestamp time;
  int width = 0;
  int height = 0;
  double white_share = 0.0;  ///< Of the pixels, at 255.
  int bright_level = 255;    ///< 99 % of the pixels are no brighter.
  bool is_blank = false;     ///< Of one brightness all over.
  bool is_copy = false;      ///< Of the frame before, pixel by pixel.
  bool tells_exposure = false;
  std::vector<SeenTag> tags = {};
};

/// What a family's codes were read as in the frames of a sample, without a corrected bit.
struct FamilyReadings {
  std::string family;
  std::size_t readings = 0;
  std::size_t frames = 0;             ///< With one or more.
  std::size_t frames_of_one_tag = 0;  ///< Of the id that is in most frames.
  double median_margin = 0.0;
};

/// One INPUT.
struct RecordingFacts {
  std::string input;
  std::string camera_name = {};
  std::optional<Camera> camera = std::nullopt;
  ResponseFinding response = {};
  bool tells_times = true;  ///< False: no time in the images' names and none given; one a second was taken.
  std::vector<FrameFacts> frames = {};  ///< In the order of time.
  std::size_t unreadable = 0;
  std::optional<ValueRange> value_range = std::nullopt;  ///< Of 16-bit image files.
  LeftOutTags left_out = {};                             ///< Readings.
  std::optional<OddPictures> odd_pictures = {};          ///< What is wrong with frames without tags.
  bool are_some_good = false;                            ///< Where odd_pictures tells of others.
  std::size_t sampled = 0;                               ///< Frames in which all families were looked for.
  std::vector<FamilyReadings> other_families = {};  ///< Those read at all, without the families asked for.
};

/// Frames of another size than the camera file's are left out by calibrate.
inline bool is_usable(const FrameFacts& frame, const std::optional<Camera>& camera) {
  return !camera || camera->width == 0 || (frame.width == camera->width && frame.height == camera->height);
}

/// All INPUTs, and how their tags are seen together.
struct Facts {
  std::vector<std::string> families;  ///< Asked for.
  std::vector<RecordingFacts> recordings = {};
  /// Tags seen from each place, by one camera or by several of a rig: each tag once (tags_by_place()).
  std::vector<std::vector<TagKey>> places = {};
  std::size_t at_rest = 0;  ///< Moments that show two tags or more, from a place that did so before.
  bool is_interrupted = false;
};

}  // namespace apriltrack::app
