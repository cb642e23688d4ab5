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
#include "apriltrack/detect/response_finding.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

// What is seen of a recording before anything is judged: plain facts, so that findings can be tested without
// images.

/// One reading of a tag in one frame.
struct SeenTag {
  TagKey tag;
  double edge_px = 0.0;    ///< Mean length of its four edges.
  double margin = 0.0;     ///< Decision margin (Detection::decision_margin), grey levels.
  int corrected_bits = 0;  ///< In its code.
  std::optional<double> blur_px = std::nullopt;  ///< motion_of_blur_px(); none where edges were hidden.
  bool is_clipped = false;                       ///< Its white is at 255 over more than 15 % of the tag.
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
  double white_share = 0.0;     ///< Share of the pixels at 255.
  int bright_level = 255;       ///< Grey level that 99 % of the pixels do not exceed.
  bool is_blank = false;        ///< is_blank().
  bool is_copy = false;         ///< It has exactly the pixels of the frame before.
  bool tells_exposure = false;  ///< The recording states this frame's exposure.
  std::vector<SeenTag> tags = {};
};

/// Readings of one tag family in a sample of the frames, without a corrected bit.
struct FamilyReadings {
  std::string family;
  std::size_t readings = 0;
  std::size_t frames = 0;             ///< That have one or more.
  std::size_t frames_of_one_tag = 0;  ///< That have the id which is in most frames.
  double median_margin = 0.0;
};

/// One recording, of one camera.
struct RecordingFacts {
  std::string input;  ///< What messages call it.
  std::string camera_name = {};
  std::optional<Camera> camera = std::nullopt;
  ResponseFinding response = {};
  bool tells_times = true;  ///< False: the images' names are no times, and no rate was given; 1 Hz is used.
  std::vector<FrameFacts> frames = {};                   ///< By time; only those that could be read.
  std::size_t unreadable = 0;                            ///< Frames that could not be read.
  std::optional<ValueRange> value_range = std::nullopt;  ///< Of 16-bit image files.
  LeftOutTags left_out = {};                             ///< Tags that were read and left out.
  std::optional<OddPictures> odd_pictures = {};          ///< What is wrong with frames without tags.
  bool are_some_good = false;                            ///< odd_pictures is about some frames only.
  std::size_t sampled = 0;                               ///< Frames in which all families were looked for.
  std::vector<FamilyReadings> other_families = {};       ///< Families read there that were not asked for.
  bool is_interrupted = false;                           ///< The look at it was stopped early.
};

/// False for frames of another size than the camera file's: a calibration leaves them out.
inline bool is_usable(const FrameFacts& frame, const std::optional<Camera>& camera) {
  return !camera || camera->width == 0 || (frame.width == camera->width && frame.height == camera->height);
}

/// All recordings, and how their tags are seen together.
struct InspectionFacts {
  std::vector<std::string> families;  ///< That were asked for.
  std::vector<RecordingFacts> recordings = {};
  /// Tags seen from each viewpoint of the camera, or of a rig, each tag once; the frames of a camera that
  /// stands still have one viewpoint.
  std::vector<std::vector<TagKey>> places = {};
  std::size_t at_rest = 0;  ///< Moments with two tags or more, from a viewpoint that had two before.
  bool is_interrupted = false;
};

}  // namespace apriltrack
