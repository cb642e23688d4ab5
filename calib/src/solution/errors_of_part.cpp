#include "solution/errors_of_part.h"

#include <Eigen/Core>

#include "cameras/time_errors.h"
#include "hypotheses/print_errors.h"
#include "uncertainty/block_scatter.h"

namespace apriltrack {
namespace {

/// That no view of the part had a share in, or that it leaves open.
const CameraRefinement* taken_cameras(const PartSolution& solution) {
  if (solution.cameras.open) return &*solution.cameras.open;
  return solution.cameras.refined.is_accepted ? &solution.cameras.refined : nullptr;
}

std::vector<ParameterView> errors_of_prints(const Observations& observations, const PartSolution& solution,
                                            const std::vector<std::size_t>& views, const MapState& state) {
  return errors_of_prints(observations, views, state, solution.print_batches, solution.print_aspect,
                          aspects_of(solution.cameras.refined));
}

/// What is left of unit errors where the cameras that were estimated take up a part of them, as poses do.
std::vector<ParameterView> when_cameras_follow(std::vector<ParameterView> errors,
                                               const std::vector<ParameterView>& cameras,
                                               const PoseInformation& poses, double noise_variance) {
  if (errors.empty()) return errors;
  const Eigen::MatrixXd both = poses.eliminate_poses(beside(cameras, errors)).information;
  const Eigen::Index num = cameras.front().by_parameter.cols(), num_errors = both.cols() - num;
  const Eigen::MatrixXd follow =
      (both.topLeftCorner(num, num) + noise_variance * Eigen::MatrixXd::Identity(num, num))
          .ldlt()
          .solve(both.topRightCorner(num, num_errors));
  for (std::size_t i = 0; i < errors.size(); ++i) errors[i].by_parameter -= cameras[i].by_parameter * follow;
  return errors;
}

/// Beside cameras that were estimated with the poses.
std::vector<ParameterView> errors_of_others(const Observations& observations, const PartSolution& solution,
                                            const PoseInformation& poses) {
  const std::vector<std::size_t>& views = solution.part.views;
  const std::vector<ParameterView> times =
      columns_of_time_errors(observations, views, solution.state, solution.time_errors);
  const std::vector<ParameterView> cameras =
      times.empty()
          ? std::vector<ParameterView>{}
          : camera_columns(observations, views, solution.state, parameters_of(solution.cameras.refined));
  return beside(errors_of_prints(observations, solution, views, solution.state),
                when_cameras_follow(times, cameras, poses, solution.scale.noise_variance));
}

/// Of cameras that were estimated with the poses: the views of the part say how unsure they are.
SharedErrors errors_of_estimates(const Observations& observations, const PartSolution& solution,
                                 const std::vector<LinearView>& views, const PoseInformation& poses) {
  const std::vector<ParameterView> columns = camera_columns(observations, solution.part.views, solution.state,
                                                            parameters_of(solution.cameras.refined));
  SharedParameters shared{poses.eliminate_poses(columns), {}};
  // One, in the units of the residuals, whose variance this is.
  const double noise_variance = solution.scale.noise_variance;
  shared.prior_precision = Eigen::VectorXd::Constant(shared.information.gradient.size(), noise_variance);
  shared.noise_factor =
      BlockScatter(views, poses).parameters_factor(columns, shared.information, noise_variance);
  return SharedErrors(shared);
}

}  // namespace

std::optional<SharedErrors> errors_of_part(const Observations& observations, const PartSolution& solution,
                                           const std::vector<LinearView>& views,
                                           const PoseInformation& poses) {
  const Part& part = solution.part;
  const bool are_estimates =
      solution.cameras.refined.is_accepted && !solution.cameras.open && !solution.are_cameras_given;
  const std::vector<ParameterView> taken =
      are_estimates ? errors_of_others(observations, solution, poses)
                    : taken_errors(observations, solution, part.views, solution.state);
  std::optional<SharedErrors> of_taken, of_estimates;
  if (!taken.empty())
    of_taken = SharedErrors(poses.eliminate_poses(taken), 1.0 / solution.scale.noise_variance);
  if (are_estimates) of_estimates = errors_of_estimates(observations, solution, views, poses);
  if (of_taken && of_estimates) return together(*of_estimates, *of_taken);
  return of_taken ? of_taken : of_estimates;
}

std::vector<ParameterView> taken_errors(const Observations& observations, const PartSolution& solution,
                                        const std::vector<std::size_t>& views, const MapState& state) {
  const CameraRefinement* cameras = taken_cameras(solution);
  const std::vector<ParameterView> of_cameras =
      cameras ? independent_errors(observations, views, state, *cameras) : std::vector<ParameterView>{};
  return beside(beside(of_cameras, errors_of_prints(observations, solution, views, state)),
                columns_of_time_errors(observations, views, state, solution.time_errors));
}

}  // namespace apriltrack
