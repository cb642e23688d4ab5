#include "constraints/measured_frame.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/QR>
#include <cmath>

#include "numerics/words.h"

namespace apriltrack {
namespace {

/// Which turns of the map no constraint determines.
enum class OpenTurns { kNone, kHeading, kAboutOneAxis, kAll };

OpenTurns open_turns(const ConstrainedFit& fit) {
  if (fit.open_directions.cols() == 0) return OpenTurns::kNone;
  const Eigen::MatrixXd open =
      fit.state.T_map_held.adjoint() * fit.open_directions;  // about the map's origin
  const Eigen::MatrixXd turns = open.bottomRows<3>();
  const auto turn_rank = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(turns).setThreshold(1e-6).rank();
  if (turn_rank == 0) return OpenTurns::kNone;
  if (turn_rank > 1) return OpenTurns::kAll;
  Eigen::Index column = 0;
  turns.colwise().norm().maxCoeff(&column);
  const bool is_heading = std::abs(turns.col(column).normalized().z()) > 1.0 - 1e-6;
  return is_heading ? OpenTurns::kHeading : OpenTurns::kAboutOneAxis;
}

/// "heading, x, y": what no constraint determines, in the axes of the map.
std::string open_in_words(const ConstrainedFit& fit) {
  if (fit.open_directions.cols() == 0) return "";
  std::vector<std::string> words;
  switch (open_turns(fit)) {
    case OpenTurns::kNone:
      break;
    case OpenTurns::kHeading:
      words.emplace_back("heading");
      break;
    case OpenTurns::kAboutOneAxis:
      words.emplace_back("a turn about one axis");
      break;
    case OpenTurns::kAll:
      words.emplace_back("orientation");
      break;
  }
  // Shifts alone: what is open of the translation without a turn.
  static constexpr const char* kAxes[] = {"x", "y", "z"};
  const Eigen::MatrixXd orthonormal = fit.open_directions;
  for (int axis = 0; axis < 3; ++axis) {
    Vector6d shift = Vector6d::Zero();
    shift.head<3>() = fit.state.T_map_held.rotation_matrix().row(axis).transpose();
    const Eigen::VectorXd open = orthonormal.transpose() * shift;
    const Vector6d rest = shift - orthonormal * open;
    if (rest.norm() < 1e-3) words.emplace_back(kAxes[axis]);
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

bool is_vertical_measured(const ConstrainedFit& fit) {
  const OpenTurns open = open_turns(fit);
  return fit.has_frame && (open == OpenTurns::kNone || open == OpenTurns::kHeading);
}

std::string gauge_in_words(const ConstrainedFit& fit, const std::vector<BoundConstraint>& constraints,
                           const TagKey& held) {
  if (!fit.has_frame) return "";
  std::vector<std::string> titles;
  for (const BoundConstraint& bound : constraints) {
    if (is_of_frame(*bound.constraint)) titles.push_back(title_of(*bound.constraint));
  }
  std::string words = "measured: " + join_first(titles, ", ", 6);
  if (const std::string open = open_in_words(fit); !open.empty())
    words += fmt::format("; kept as with {} held at the origin: {}", to_string(held), open);
  return words;
}

}  // namespace apriltrack
