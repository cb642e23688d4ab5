#include "apriltrack/calib/calibration_finding.h"

namespace apriltrack {

std::string_view to_string(CalibrationFinding::Kind kind) {
  using Kind = CalibrationFinding::Kind;
  switch (kind) {
    case Kind::kWrongSize:
      return "wrong_size";
    case Kind::kMoved:
      return "moved";
    case Kind::kDuplicateId:
      return "duplicate_id";
    case Kind::kBent:
      return "bent";
    case Kind::kLoose:
      return "loose";
    case Kind::kContradictsOthers:
      return "contradicts_others";
    case Kind::kAmbiguousPose:
      return "ambiguous_pose";
    case Kind::kMostlyRejected:
      return "mostly_rejected";
    case Kind::kOftenRejected:
      return "often_rejected";
    case Kind::kLostWithOthers:
      return "lost_with_others";
    case Kind::kNeverWithOthers:
      return "never_with_others";
    case Kind::kRarelyWithOthers:
      return "rarely_with_others";
    case Kind::kUnusualSize:
      return "unusual_size";
    case Kind::kNotRefined:
      return "not_refined";
    case Kind::kSeparateComponent:
      return "separate_component";
    case Kind::kUnsolvedComponent:
      return "unsolved_component";
    case Kind::kInconsistentLink:
      return "inconsistent_link";
    case Kind::kDisplacedAtRest:
      return "displaced_at_rest";
    case Kind::kSizeGroups:
      return "size_groups";
    case Kind::kPrintAnisotropy:
      return "print_anisotropy";
    case Kind::kUnusableCorners:
      return "unusable_corners";
    case Kind::kPictureSize:
      return "picture_size";
    case Kind::kStationaryFrames:
      return "stationary_frames";
    case Kind::kRepeatedFrames:
      return "repeated_frames";
    case Kind::kManyRejected:
      return "many_rejected";
    case Kind::kHighResiduals:
      return "high_residuals";
    case Kind::kNoCovariances:
      return "no_covariances";
    case Kind::kOtherLens:
      return "other_lens";
    case Kind::kOtherPlaces:
      return "other_places";
    case Kind::kOpenCamera:
      return "open_camera";
    case Kind::kCameraCorrected:
      return "camera_corrected";
    case Kind::kCameraNotRefined:
      return "camera_not_refined";
    case Kind::kEdgeOffset:
      return "edge_offset";
    case Kind::kReadout:
      return "readout";
    case Kind::kDelay:
      return "delay";
    case Kind::kUnusedConstraint:
      return "unused_constraint";
    case Kind::kConstraintInDoubt:
      return "constraint_in_doubt";
    case Kind::kFrameNotMeasured:
      break;
  }
  return "frame_not_measured";
}

std::vector<std::string> messages_of(const std::vector<CalibrationFinding>& findings) {
  std::vector<std::string> messages;
  for (const CalibrationFinding& finding : findings) messages.push_back(finding.message);
  return messages;
}

}  // namespace apriltrack
