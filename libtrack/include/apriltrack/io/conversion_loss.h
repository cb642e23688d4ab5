#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace apriltrack {

/// What another format of maps, cameras or trajectories cannot hold, or did not say. In brackets what
/// ConversionLoss::value and ConversionLoss::numbers are.
enum class LossKind {
  // of a map
  kSizes,       ///< Of the tags.
  kFamilies,    ///< Of the tags [value: the families].
  kCovariance,  ///< Of the tags' poses [value: what is in the file instead].
  kTags,        ///< Tags that are not in the result [value: which, where `which` cannot name them].
  kFrameName,   ///< Name of the map's frame [value: the name].
  kOrigin,      ///< Where the origin lies: a field's corner, or its centre [value: the frame that was wanted;
                ///< numbers: metres that were added to x, y and z].
  kFieldSize,   ///< Length and width of a field.
  kMatrixOrder,  ///< Matrices that were written column by column.
  kProvenance,   ///< What made the map.
  kStatistics,   ///< Of the tags.
  kExtensions,   ///< `x_...` keys [value: their names].
  kForeignKeys,  ///< Keys of the other format that a map has no place for [value: their names].
  // of a camera
  kResolution,     ///< [value: "640 x 480".]
  kResponse,       ///< [value: its name; "auto" where it was to be estimated.]
  kExposure,       ///< [numbers: seconds.]
  kLineDelay,      ///< [numbers: seconds per row.]
  kExtrinsics,     ///< The place of a camera on its rig, relative to the IMU or in a reference frame [value:
                   ///< what states it; numbers: of a stereo pair's second camera, metres to the right of the
                   ///< first, and below].
  kRectification,  ///< How pictures are rectified: a rotation, or another projection [value: what states it].
  kNames,          ///< What a camera is called [value: what it is called instead].
  kFurtherCameras,  ///< All but one camera of a rig.
  kSkew,        ///< Axes of the picture that are not at a right angle [value: where it stands; numbers: the
                ///< skew in pixels, and how far it moves points at most].
  kLensTerms,   ///< Terms of a lens that ours has not, fitted by those that it has [value: where they stand;
                ///< numbers: of coefficients, largest and RMS error of the fit in pixels].
  kUnreadLens,  ///< Written, and read by us, but not by the program whose format it is [numbers: of
                ///< coefficients, and what that program takes at most].
  kCameraKeys,  ///< Keys of other programs, or of the file's owner, that are not for AprilTrack [value: their
                ///< names].
  // of a trajectory
  kTimes,       ///< Of the poses [value: the file that has them, or the rate].
  kVelocities,  ///< Of the origin of the moving frame.
  kBiases,      ///< Of an IMU.
};

/// What a kind is about.
enum class LossSubject { kMap, kCamera, kTrajectory };

/// All kinds.
std::span<const LossKind> loss_kinds();

/// What became of it.
enum class LossHow {
  kLeftOut,    ///< It was there, and is not in the result.
  kAssumed,    ///< It was not there, and the result has a value that nobody stated.
  kGiven,      ///< It was not there, and the result has what the caller gave.
  kConverted,  ///< It is in the result in another form or place.
  kUnknown,    ///< It was not there, and the result stays as it is.
};

/// One thing to know about a conversion. The words for it are the caller's.
struct ConversionLoss {
  LossKind kind = LossKind::kSizes;
  LossHow how = LossHow::kLeftOut;
  std::vector<std::string> which = {};  ///< Tags ("tag36h11/7") or cameras; empty: all, or the file itself.
  std::string value = {};
  std::vector<double> numbers = {};
};

/// "sizes", "frame_name", "line_delay", ...: the word for machines.
std::string_view to_string(LossKind kind);
LossSubject subject_of(LossKind kind);
/// "left_out", "assumed", "given", "converted", "unknown".
std::string_view to_string(LossHow how);

}  // namespace apriltrack
