#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

/// Something that a calibration found, and that whoever uses the map should know.
///
/// Programs read the typed fields; `message` is the same for people, with the way out. What `value` is of
/// each kind stands in docs/file_formats.md; it is absent where the kind has no number.
struct CalibrationFinding {
  enum class Kind {
    // A tag.
    kWrongSize,          ///< Not of the size that was stated. value: its size over the stated one.
    kMoved,              ///< Hung elsewhere from a moment on. value: how far, m.
    kDuplicateId,        ///< Two tags of one id. value: how far apart, m, where they were not seen at once.
    kBent,               ///< Not flat, or not square. value: the larger of twist and aspect, of its size.
    kLoose,              ///< No fixed place explains its views.
    kContradictsOthers,  ///< Its views contradict those of the other tags, and no fault explains why.
    kAmbiguousPose,      ///< Its views agree with two poses about equally well.
    kMostlyRejected,     ///< Most of its views were rejected; it is left out.
    kOftenRejected,      ///< Many of its views were rejected; it stays. value: the share.
    kLostWithOthers,     ///< Only views that were rejected, or tags that were left out, join it to the rest.
    kNeverWithOthers,    ///< Never seen together with another tag.
    kRarelyWithOthers,   ///< Seen together with others in fewer frames than CalibrationOptions::min_views.
    kUnusualSize,        ///< Its stated size is hardly one in metres. value: that size, m.
    kNotRefined,         ///< Stays where its corners have it: too few pictures can be used.
    // How tags are joined.
    kSeparateComponent,  ///< Tags that no frame joins to the map. They have a map of their own.
    kUnsolvedComponent,  ///< The same, but no map of them was found.
    kInconsistentLink,   ///< Two tags that frames show together otherwise than the map has them.
    kDisplacedAtRest,  ///< Not where the map has it while the camera stood still. value: in how many frames.
    // Prints, frames and corners.
    kSizeGroups,        ///< Tags seem printed at two scales. tags: the larger. value: their ratio.
    kPrintAnisotropy,   ///< Tags seem printed wider than high. value: width over height.
    kUnusableCorners,   ///< Detections that no tag can show. value: how many.
    kPictureSize,       ///< Corners that seem to be of pictures of another size than the camera file's.
    kStationaryFrames,  ///< Frames that count with another one of the same place. value: how many.
    kRepeatedFrames,    ///< Frames with exactly the corners of an earlier one. value: how many.
    kManyRejected,      ///< Views of all tags that were rejected as outliers. value: the share.
    kHighResiduals,     ///< value: rms per axis, px.
    kNoCovariances,     ///< The map has too many tags. value: how many.
    // Cameras.
    kOtherLens,         ///< The camera file's lens does not fit, and is kept.
    kOtherPlaces,       ///< The rig's extrinsics do not fit, and are kept.
    kOpenCamera,        ///< Views propose other numbers, and too few frames decide. Covariances count it.
    kCameraCorrected,   ///< The camera file does not fit; the map rests on corrected numbers.
    kCameraNotRefined,  ///< It was asked for, and is not done.
    kEdgeOffset,        ///< Edges lie off by more than is usual. value: px.
    kReadout,           ///< A rolling shutter. value: from the first row to the last, s.
    kDelay,             ///< A camera is later than another. value: by so much, s.
    // Constraints.
    kUnusedConstraint,
    kConstraintInDoubt,
    kFrameNotMeasured,  ///< No constraint that tells the map's frame is used.
  };

  Kind kind = Kind::kContradictsOthers;
  std::vector<TagKey> tags = {};
  std::vector<std::string> cameras = {};
  std::optional<double> value = std::nullopt;
  std::string_view unit = {};  ///< Of value and sigma: "m", "s", "px", "1". Lives as long as the program.
  std::optional<double> sigma = std::nullopt;
  /// Of kMoved: the first frame after it. Of kDisplacedAtRest: the first frame.
  std::optional<Timestamp> timestamp = std::nullopt;
  /// Other tags, or boards of several, any of which may be at fault instead; the views do not tell which.
  std::vector<std::vector<TagKey>> alternatives = {};
  bool is_in_doubt = false;  ///< Another tag may be at fault instead, named by `alternatives` or not.
  bool is_left_out = false;  ///< `tags` are in no map for it.
  std::optional<double> log_odds = std::nullopt;  ///< Of this against no fault, nats, where they are known.
  std::string message = {};
};

/// "wrong_size", "moved", ...: as in JSON.
std::string_view to_string(CalibrationFinding::Kind kind);

/// The messages, in order.
std::vector<std::string> messages_of(const std::vector<CalibrationFinding>& findings);

}  // namespace apriltrack
