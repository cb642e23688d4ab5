#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apriltrack/calib/systematic_errors.h"
#include "apriltrack/camera/camera.h"
#include "model/map_state.h"
#include "uncertainty/pose_information.h"

namespace apriltrack {

/// A number of a camera that can be estimated beside the poses.
struct CameraParameter {
  enum class Kind { kEdgeOffset, kFocalLength, kAspect, kCenter, kDistortion, kTranslation, kRotation };

  int camera = 0;
  Kind kind = Kind::kFocalLength;
  int index = 0;  ///< Of a kind that has several.
  /// How well it is known before: px, shares of the focal length, metres, radians.
  double sigma = 0.0;
  double widened = 1.0;  ///< So many times what files of the same camera are off by is `sigma`.

  bool is_of_lens() const { return kind >= Kind::kFocalLength && kind <= Kind::kDistortion; }
  bool is_of_place() const { return kind >= Kind::kTranslation; }
};

using CameraParameters = std::vector<CameraParameter>;

CameraParameters operator+(CameraParameters some, const CameraParameters& more);

/// "edge offset", "focal length", "k1".
std::string name_of(const CameraParameter& parameter, const RigCamera& camera);

/// "px", "1", "m" or "rad".
std::string unit_of(const CameraParameter& parameter);

CameraParameters edge_offset_parameters(const std::vector<int>& cameras, double sigma_px);
/// Focal length, aspect, principal point, distortion of each.
CameraParameters intrinsic_parameters(const std::vector<int>& cameras, const std::vector<RigCamera>& rig);
/// Of each but the first.
CameraParameters extrinsic_parameters(const std::vector<int>& cameras);

/// What a correction is of; nullopt where the rig has no such camera, or that no such parameter.
std::optional<CameraParameter> parameter_of(const CameraCorrection& correction,
                                            const std::vector<RigCamera>& rig);

/// The camera with the parameter moved by `step`; nullopt where no lens has that: numbers that are not
/// finite, or a focal length that is not above 0.
std::optional<RigCamera> moved(const RigCamera& camera, const CameraParameter& parameter, double step);

/// By how much moved() took the parameter from one camera to the other; of places to first order.
double difference(const RigCamera& from, const RigCamera& to, const CameraParameter& parameter);

/// Another lens, whatever its place and the edges that are seen by it.
bool has_other_lens(const RigCamera& camera, const RigCamera& than);
bool have_other_lenses(const std::vector<RigCamera>& cameras, const std::vector<RigCamera>& than);

/// The rig with the lenses of `cameras`, and the places of those that had `parameters` of theirs estimated.
CameraRig with_corrections(const CameraRig& rig, const std::vector<RigCamera>& cameras,
                           const CameraParameters& parameters);

/// The whitened residuals of `views` by the parameters, in units of their sigmas; by central differences.
std::vector<ParameterView> camera_columns(const Observations& observations,
                                          const std::vector<std::size_t>& views, const MapState& state,
                                          const CameraParameters& parameters);

/// The same in units in which the parameters' errors are independent and of variance one. columns: of
/// parameters with a sigma of one; covariance: of these.
std::vector<ParameterView> with_independent_errors(std::vector<ParameterView> columns,
                                                   const Eigen::MatrixXd& covariance);

}  // namespace apriltrack
