#include "cameras/time_errors.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "apriltrack/calib/systematic_errors.h"
#include "cameras/camera_refinement.h"
#include "solve/camera_parameters.h"

namespace apriltrack {
namespace {

constexpr double kMostApart_s = 0.15;    // over longer stretches no hand moves evenly
constexpr double kLeastApart_s = 0.005;  // nearer ones are one moment, by clocks that differ
// Standard deviations before anything is asked, and what is never worth telling. Whole milliseconds are
// usual among triggered cameras that are told their times by a driver.
constexpr double kUsualReadout_s = 0.05, kUsualDelay_s = 0.05;
constexpr double kLeastReadout_s = 0.004, kLeastDelay_s = 0.001;
constexpr double kClearly = 5.0;  // sigmas

using Kind = TimeError::Kind;

/// Where the corners of views go: px/s, by the poses of the moments before and after.
class CornerSpeeds {
 public:
  CornerSpeeds(const Observations& observations, const std::vector<std::size_t>& views, const MapState& state)
      : observations_(observations), state_(state) {
    std::set<int> frames;
    for (const std::size_t v : views) frames.insert(observations.views[v].frame);
    std::vector<int> by_time(frames.begin(), frames.end());
    std::ranges::sort(by_time, {}, [&](int frame) { return time_of(frame); });
    const std::vector<int> backwards(by_time.rbegin(), by_time.rend());
    for (const auto& [frame, before] : next_in(backwards)) neighbours_[frame] = {before, frame};
    for (const auto& [frame, after] : next_in(by_time)) neighbours_[frame].second = after;
  }

  /// Zero where that is not known.
  Vector8d of(const TagView& view) const {
    const auto [before, after] = neighbours_.at(view.frame);
    const double apart_s = seconds_between(time_of(before), time_of(after));
    TagView there = view;
    Vector8d first_px, last_px;
    there.frame = before;
    if (!(apart_s > 0.0) || !residual_of(observations_, there, state_, &first_px)) return Vector8d::Zero();
    there.frame = after;
    if (!residual_of(observations_, there, state_, &last_px)) return Vector8d::Zero();
    return (last_px - first_px) / apart_s;
  }

 private:
  /// Each frame's next one at another moment; itself where none is near.
  std::map<int, int> next_in(const std::vector<int>& frames) const {
    std::map<int, int> result;
    std::size_t next = 0;
    for (const int frame : frames) {
      const auto apart_s = [&] { return std::abs(seconds_between(time_of(frame), time_of(frames[next]))); };
      while (next < frames.size() && apart_s() < kLeastApart_s) ++next;
      result[frame] = next < frames.size() && apart_s() <= kMostApart_s ? frames[next] : frame;
    }
    return result;
  }

  Timestamp time_of(int frame) const { return observations_.frames[static_cast<std::size_t>(frame)]; }

  const Observations& observations_;
  const MapState& state_;
  std::map<int, std::pair<int, int>> neighbours_;  ///< Of a frame; itself where there is none near.
};

/// Of a picture whose centre is its lens's, about; where that cannot be, rows without end have no times.
double num_rows(const RigCamera& camera) {
  const double cy = camera.model.pinhole().cy;
  return cy > 0.0 ? 2.0 * cy : std::numeric_limits<double>::infinity();
}

/// Of whitened residuals by one second of the error.
Vector8d by_second(const TagView& view, const Vector8d& speed_px_s, const RigCamera& camera, Kind kind,
                   const MapState& state) {
  if (kind == Kind::kDelay) return whitening(view, state) * speed_px_s;
  Vector8d shift_px = speed_px_s;
  for (int corner = 0; corner < kNumCorners; ++corner) {
    const double row = view.corners_px[static_cast<std::size_t>(corner)].y();
    shift_px.segment<2>(2 * corner) *= (row - camera.model.pinhole().cy) / num_rows(camera);
  }
  return whitening(view, state) * shift_px;
}

/// A column for each of `errors` by `unit_s` of it, of the views of its camera.
std::vector<ParameterView> columns_of(const Observations& observations, const std::vector<std::size_t>& views,
                                      const MapState& state, const std::vector<TimeError>& errors,
                                      const std::vector<double>& unit_s) {
  const CornerSpeeds speeds(observations, views, state);
  std::vector<ParameterView> columns;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const TagView& view = observations.views[views[i]];
    const RigCamera& camera = observations.cameras[static_cast<std::size_t>(view.camera)];
    ParameterView column{i, Eigen::MatrixXd::Zero(8, static_cast<Eigen::Index>(errors.size()))};
    const Vector8d speed_px_s = speeds.of(view);
    for (std::size_t k = 0; k < errors.size(); ++k) {
      if (errors[k].camera == camera.name)
        column.by_parameter.col(static_cast<Eigen::Index>(k)) =
            unit_s[k] * by_second(view, speed_px_s, camera, errors[k].kind, state);
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

/// Of each camera that sees the part.
std::vector<TimeError> what_to_ask(const Observations& observations, const std::vector<std::size_t>& views) {
  std::set<int> cameras;
  for (const std::size_t v : views) cameras.insert(observations.views[v].camera);
  std::vector<TimeError> errors;
  for (const int camera : cameras) {
    const std::string& name = observations.cameras[static_cast<std::size_t>(camera)].name;
    errors.push_back({name, Kind::kReadout});
    if (camera == *cameras.begin()) continue;
    errors.push_back({name, Kind::kDelay});
    errors.back().first_camera = observations.cameras[static_cast<std::size_t>(*cameras.begin())].name;
  }
  return errors;
}

bool is_clear(const TimeError& error) {
  const double least_s = error.kind == Kind::kReadout ? kLeastReadout_s : kLeastDelay_s;
  return std::abs(error.value_s) > std::max(least_s, kClearly * error.sigma_s);
}

/// To first order, the poses and `others` free to follow.
void estimate(const Observations& observations, const LinearPart& part, const MapState& state,
              const CameraParameters& others, std::vector<TimeError>& errors) {
  std::vector<double> unit_s;
  for (const TimeError& error : errors)
    unit_s.push_back(error.kind == Kind::kReadout ? kUsualReadout_s : kUsualDelay_s);
  std::vector<ParameterView> columns = columns_of(observations, part.part.views, state, errors, unit_s);
  if (!others.empty())
    columns = beside(std::move(columns), camera_columns(observations, part.part.views, state, others));
  const ParameterInformation asked = part.poses->eliminate_poses(columns);
  const Eigen::MatrixXd prior =  // of unit variance, in the units of the residuals
      part.scale.noise_variance *
      Eigen::MatrixXd::Identity(asked.information.rows(), asked.information.cols());
  const Eigen::LDLT<Eigen::MatrixXd> system(asked.information + prior);
  const Eigen::VectorXd value = -system.solve(asked.gradient);
  const Eigen::MatrixXd spread = gradient_covariance(asked, part.scale) + prior * prior;
  const Eigen::MatrixXd covariance = system.solve(system.solve(spread).transpose());
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    errors[k].value_s = unit_s[k] * value[i];
    errors[k].sigma_s = unit_s[k] * std::sqrt(std::max(0.0, covariance(i, i)));
  }
}

}  // namespace

std::vector<TimeError> find_time_errors(const Observations& observations, const LinearPart& part,
                                        const MapState& state) {
  std::vector<TimeError> errors = what_to_ask(observations, part.part.views);
  estimate(observations, part, state, {}, errors);
  if (std::ranges::none_of(errors, is_clear)) return {};
  // Where all moves one way, a lens or a baseline that is a little off looks like times.
  const std::vector<int> cameras = cameras_of(observations, part.part);
  estimate(observations, part, state,
           intrinsic_parameters(cameras, observations.cameras) + extrinsic_parameters(cameras), errors);
  std::erase_if(errors, [](const TimeError& error) { return !is_clear(error); });
  return errors;
}

std::vector<TimeError> by_the_larger(std::vector<TimeError> errors, const std::vector<TimeError>& before) {
  for (TimeError& error : errors) {
    for (const TimeError& other : before) {
      if (error.camera == other.camera && error.kind == other.kind &&
          std::abs(other.value_s) > std::abs(error.value_s))
        error = other;
    }
  }
  return errors;
}

std::vector<TimeError> with_known(std::vector<TimeError> known, const std::vector<TimeError>& found) {
  const std::size_t num_known = known.size();
  for (const TimeError& error : found) {
    const auto end = known.begin() + static_cast<std::ptrdiff_t>(num_known);
    const auto is_same = [&](const TimeError& other) {
      return error.camera == other.camera && error.kind == other.kind;
    };
    if (std::none_of(known.begin(), end, is_same)) known.push_back(error);
  }
  return known;
}

std::vector<ParameterView> columns_of_time_errors(const Observations& observations,
                                                  const std::vector<std::size_t>& views,
                                                  const MapState& state,
                                                  const std::vector<TimeError>& errors) {
  if (errors.empty()) return {};
  std::vector<double> unit_s;  // the map is without them
  for (const TimeError& error : errors) unit_s.push_back(std::hypot(error.value_s, error.sigma_s));
  return columns_of(observations, views, state, errors, unit_s);
}

}  // namespace apriltrack
