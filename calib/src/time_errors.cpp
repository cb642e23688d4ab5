#include "time_errors.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace apriltrack {
namespace {

constexpr double kMostApart_s = 0.15;  // over longer stretches no hand moves evenly
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
    for (std::size_t i = 0; i < by_time.size(); ++i) {
      const auto near = [&](std::size_t other) {
        const double apart_s = std::abs(seconds_between(time_of(by_time[i]), time_of(by_time[other])));
        return apart_s <= kMostApart_s ? by_time[other] : by_time[i];
      };
      neighbours_[by_time[i]] = {i > 0 ? near(i - 1) : by_time[i],
                                 i + 1 < by_time.size() ? near(i + 1) : by_time[i]};
    }
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
  Timestamp time_of(int frame) const { return observations_.frames[static_cast<std::size_t>(frame)]; }

  const Observations& observations_;
  const MapState& state_;
  std::map<int, std::pair<int, int>> neighbours_;  ///< Of a frame; itself where there is none near.
};

double num_rows(const RigCamera& camera) {
  return 2.0 * camera.model.pinhole().cy;  // of a picture whose centre is its lens's, about
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

}  // namespace

std::vector<TimeError> find_time_errors(const Observations& observations, const LinearPart& part,
                                        const MapState& state) {
  std::vector<TimeError> errors = what_to_ask(observations, part.part.views);
  std::vector<double> unit_s;
  for (const TimeError& error : errors)
    unit_s.push_back(error.kind == Kind::kReadout ? kUsualReadout_s : kUsualDelay_s);
  const ParameterInformation asked =
      part.poses->eliminate_poses(columns_of(observations, part.part.views, state, errors, unit_s));
  const auto num = static_cast<Eigen::Index>(errors.size());
  const Eigen::LDLT<Eigen::MatrixXd> system(asked.information +
                                            part.scale.noise_variance * Eigen::MatrixXd::Identity(num, num));
  const Eigen::VectorXd value = -system.solve(asked.gradient);
  const Eigen::MatrixXd covariance =
      system.solve(system.solve(gradient_covariance(asked, part.scale)).transpose());
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    errors[k].value_s = unit_s[k] * value[i];
    errors[k].sigma_s = unit_s[k] * std::sqrt(std::max(0.0, covariance(i, i)));
  }
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

std::vector<ParameterView> columns_of_time_errors(const Observations& observations,
                                                  const std::vector<std::size_t>& views,
                                                  const MapState& state,
                                                  const std::vector<TimeError>& errors) {
  if (errors.empty()) return {};
  std::vector<double> unit_s;  // the map is without them
  for (const TimeError& error : errors) unit_s.push_back(std::hypot(error.value_s, error.sigma_s));
  return columns_of(observations, views, state, errors, unit_s);
}

std::string words_of(const TimeError& error) {
  const double value_ms = 1e3 * error.value_s, sigma_ms = 1e3 * error.sigma_s;
  constexpr std::string_view kWhatFollows =
      "Sound tags may be accused for it. The covariances count it, and the map is not refined on pictures";
  if (error.kind == Kind::kReadout)
    return fmt::format(
        "{}: the rows of a picture look as if they were taken one after another, over {:.1f} ms from the "
        "first to the last (sigma {:.1f}): a rolling shutter, which bends what moves. Film anew, more slowly "
        "or standing still for each picture, or with a global shutter. {}",
        error.camera, value_ms, sigma_ms, kWhatFollows);
  return fmt::format(
      "{}: its pictures look as if they were taken {:.1f} ms (sigma {:.1f}) {} those of {} that have the "
      "same "
      "times. Trigger the cameras together, or correct the times. {}",
      error.camera, std::abs(value_ms), sigma_ms, value_ms > 0.0 ? "after" : "before", error.first_camera,
      kWhatFollows);
}

}  // namespace apriltrack
