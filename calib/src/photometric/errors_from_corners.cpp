#include "photometric/errors_from_corners.h"

#include <utility>

#include "apriltrack/calib/systematic_errors.h"
#include "hypotheses/print_errors.h"
#include "solve/camera_parameters.h"

namespace apriltrack {
namespace {

/// The pictures as if they were corners, whose residuals are pixels.
struct PictureCorners {
  Observations observations;
  MapState state;
  std::vector<std::size_t> numbers;
};

PictureCorners corners_of(const CalibrationResult& calibration, const PhotometricScene& scene,
                          const std::vector<TagKey>& keys, const PhotometricState& state,
                          const std::vector<LinearView>& views) {
  PictureCorners corners;
  Observations& seen = corners.observations;
  seen.tags = keys;
  for (std::size_t c = 0; c < scene.cameras.size(); ++c)
    seen.cameras.push_back(
        {scene.cameras[c].model, scene.T_camera_rig[c], 0.0, calibration.rig.cameras[c].name});
  for (const PrintedTag& tag : scene.tags) seen.sizes_m.push_back(2.0 * tag.half_size_m);
  CornersPx nowhere;  // residuals less what was seen: their derivatives do not ask
  nowhere.fill(Eigen::Vector2d::Zero());
  for (const LinearView& view : views) {
    corners.numbers.push_back(seen.views.size());
    seen.views.push_back(
        {view.tag, view.frame, view.camera, nowhere, Matrix8d::Identity(), Vector8d::Zero()});
  }
  corners.state = {state.T_map_tag, state.T_map_rig, seen.cameras, {}};
  return corners;
}

/// Those that pictures follow: edge offsets are of the detector.
struct Estimated {
  CameraParameters parameters;  ///< With a sigma of one.
  Eigen::MatrixXd covariance;
};

Estimated estimated_cameras(const CalibrationResult& calibration, const std::vector<RigCamera>& cameras) {
  Estimated estimated;
  std::vector<Eigen::Index> places;
  const bool are_open = !calibration.open_corrections.empty();  // then all that is unsure is among these
  const auto& corrections = are_open ? calibration.open_corrections : calibration.corrections;
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    auto parameter = parameter_of(corrections[i], cameras);
    if (!parameter || parameter->kind == CameraParameter::Kind::kEdgeOffset) continue;
    parameter->sigma = 1.0;
    estimated.parameters.push_back(*parameter);
    places.push_back(static_cast<Eigen::Index>(i));
  }
  estimated.covariance =
      (are_open ? calibration.open_covariance : calibration.corrections_covariance)(places, places);
  return estimated;
}

/// None where pictures follow no camera.
std::vector<ParameterView> columns_of_cameras(const CalibrationResult& calibration,
                                              const PictureCorners& corners) {
  if (calibration.corrections.empty() && calibration.open_corrections.empty()) return {};
  const Estimated cameras = estimated_cameras(calibration, corners.observations.cameras);
  if (cameras.parameters.empty()) return {};
  return with_independent_errors(
      camera_columns(corners.observations, corners.numbers, corners.state, cameras.parameters),
      cameras.covariance);
}

/// That were refined: pictures take them as they are.
CameraParameters refined_aspects(const CalibrationResult& calibration,
                                 const std::vector<RigCamera>& cameras) {
  CameraParameters aspects;
  for (const CameraCorrection& correction : calibration.corrections) {
    const auto parameter = parameter_of(correction, cameras);
    if (parameter && parameter->kind == CameraParameter::Kind::kAspect) aspects.push_back(*parameter);
  }
  return aspects;
}

}  // namespace

std::optional<SharedErrors> errors_from_corners(const CalibrationResult& calibration,
                                                const PhotometricScene& scene,
                                                const std::vector<TagKey>& keys,
                                                const PhotometricState& state,
                                                const std::vector<LinearView>& views,
                                                const PoseInformation& poses, const ErrorScale& scale) {
  const PictureCorners corners = corners_of(calibration, scene, keys, state, views);
  const Observations& seen = corners.observations;
  std::vector<ParameterView> columns =
      beside(columns_of_cameras(calibration, corners),
             errors_of_prints(seen, corners.numbers, corners.state, calibration.print_batches,
                              calibration.print_aspect, refined_aspects(calibration, seen.cameras)));
  if (columns.empty()) return std::nullopt;
  for (ParameterView& column : columns)
    column.by_parameter = (views[column.view].by_error * column.by_parameter).eval();
  // The scale turns one into the variance of the noise, which these errors already have.
  return SharedErrors(poses.eliminate_poses(columns), 1.0 / scale.noise_variance);
}

}  // namespace apriltrack
