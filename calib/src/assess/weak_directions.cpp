#include "assess/weak_directions.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "apriltrack/base/degrees.h"
#include "assess/view_summary.h"
#include "numerics/upper_median.h"
#include "numerics/words.h"

namespace apriltrack {
namespace {

constexpr double kClearlyWeaker = 5.0;  // than the median tag
constexpr double kWorthTelling = 0.1;   // of what is weak
constexpr double kAlike = 0.8;          // of two sigmas

/// The widest axis of a 3 x 3 covariance.
struct WidestAxis {
  double sigma = 0.0;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  bool is_any_in_plane = false;  ///< x and y alike, and anything between.
};

WidestAxis widest_axis(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  WidestAxis widest;
  widest.sigma = std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
  widest.axis = solver.eigenvectors().col(2);
  Eigen::Index largest = 0;
  widest.axis.cwiseAbs().maxCoeff(&largest);
  if (widest.axis[largest] < 0.0) widest.axis = -widest.axis;
  const double second = std::sqrt(std::max(0.0, solver.eigenvalues()[1]));
  widest.is_any_in_plane = second > kAlike * widest.sigma && std::abs(solver.eigenvectors()(2, 0)) > 0.9;
  return widest;
}

std::string axis_in_words(const WidestAxis& widest) {
  constexpr double kAlong = 0.94, kInPlane = 0.34;  // 20 degrees, both
  if (widest.is_any_in_plane) return "any axis in its plane";
  const Eigen::Vector3d& axis = widest.axis;
  constexpr const char* kNames[] = {"its x axis (which points right)", "its y axis (which points down)",
                                    "its z axis (which points into it)"};
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (std::abs(axis[i]) > kAlong) return kNames[i];
  }
  if (std::abs(axis.z()) < kInPlane) {
    const double angle = std::atan2(axis.y(), axis.x()) * kDegPerRad;
    return fmt::format("the axis in its plane that is {:.0f} degrees from right towards down",
                       angle < 0.0 ? angle + 180.0 : angle);
  }
  return fmt::format("the axis ({:.1f} right, {:.1f} down, {:.1f} into it)", axis.x(), axis.y(), axis.z());
}

std::string words_of(const WeakDirection& one) {
  const std::string sigma = one.is_rotation ? in_two_digits(one.sigma * kDegPerRad) + " degrees"
                                            : in_two_digits(1e3 * one.sigma) + " mm";
  return fmt::format("{} of {} is {} observed: sigma {} relative to {}; {}", one.direction,
                     to_string(one.tag), one.weakness > 1.0 ? "barely" : "less well", sigma,
                     to_string(one.neighbour), one.reason);
}

/// The tag that is seen together with this one and knows it best, and in how many moments.
struct Neighbour {
  int tag = 0;
  int frames = 0;
  Matrix6d covariance = Matrix6d::Zero();
  double weakness = 0.0;
};

std::optional<Neighbour> best_neighbour(const TagMap& map, const JointCovariance& joint,
                                        const std::vector<SeenTogether>& links, int tag) {
  std::optional<Neighbour> best;
  const MapTag& own = map.tags[static_cast<std::size_t>(tag)];
  for (const SeenTogether& link : links) {
    if (link.tag_a != tag && link.tag_b != tag) continue;
    const int other = link.tag_a == tag ? link.tag_b : link.tag_a;
    const auto covariance =
        relative_covariance(map, joint, map.tags[static_cast<std::size_t>(other)].key, own.key);
    if (!covariance) continue;
    const double weakness = weakness_of(*covariance, own.size_m);
    if (!best || weakness < best->weakness) best = Neighbour{other, link.frames, *covariance, weakness};
  }
  return best;
}

WeakDirection weakest_direction(const TagMap& map, const MapEvidence& evidence, int tag,
                                const Neighbour& neighbour) {
  const MapTag& own = map.tags[static_cast<std::size_t>(tag)];
  const WidestAxis position = widest_axis(neighbour.covariance.topLeftCorner<3, 3>());
  const WidestAxis rotation = widest_axis(neighbour.covariance.bottomRightCorner<3, 3>());
  const double of_position = position.sigma / (kWeakPosition * own.size_m);
  const double of_rotation = rotation.sigma / kWeakRotation_rad;
  WeakDirection result;
  result.tag = own.key;
  result.neighbour = map.tags[static_cast<std::size_t>(neighbour.tag)].key;
  result.is_rotation = of_rotation >= of_position;
  const WidestAxis& widest = result.is_rotation ? rotation : position;
  result.axis = widest.axis;
  result.sigma = widest.sigma;
  result.weakness = std::max(of_position, of_rotation);
  result.direction = (result.is_rotation ? "rotation about " : "position along ") + axis_in_words(widest);
  result.reason = summary_of_views(evidence, tag, to_string(result.neighbour), neighbour.frames);
  return result;
}

/// Where all tags are known well, one that is known much less is still worth a word.
void mark_weak_ones(std::vector<WeakDirection>& directions) {
  if (directions.empty()) return;
  std::vector<double> weaknesses;
  for (const WeakDirection& one : directions) weaknesses.push_back(one.weakness);
  const double usual = upper_median(std::move(weaknesses));
  for (WeakDirection& one : directions) {
    one.is_weak =
        one.weakness > 1.0 || (one.weakness > kWorthTelling && one.weakness > kClearlyWeaker * usual);
    one.words = words_of(one);
  }
}

}  // namespace

double weakness_of(const Matrix6d& covariance, double size_m) {
  return std::max(widest_axis(covariance.topLeftCorner<3, 3>()).sigma / (kWeakPosition * size_m),
                  widest_axis(covariance.bottomRightCorner<3, 3>()).sigma / kWeakRotation_rad);
}

std::vector<WeakDirection> weak_directions(const TagMap& map, const JointCovariance& joint,
                                           const MapEvidence& evidence,
                                           const std::vector<SeenTogether>& links) {
  std::vector<WeakDirection> directions;
  for (std::size_t tag = 0; tag < map.tags.size(); ++tag) {
    if (!joint.row_of(map.tags[tag].key)) continue;
    const auto neighbour = best_neighbour(map, joint, links, static_cast<int>(tag));
    if (neighbour) directions.push_back(weakest_direction(map, evidence, static_cast<int>(tag), *neighbour));
  }
  mark_weak_ones(directions);
  return directions;
}

}  // namespace apriltrack
