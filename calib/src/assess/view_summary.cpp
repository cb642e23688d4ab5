#include "assess/view_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "apriltrack/base/degrees.h"
#include "numerics/upper_median.h"
#include "observations/observations.h"

namespace apriltrack {
namespace {

constexpr double kHeadOn_rad = 25.0 / kDegPerRad;
constexpr double kOneSide_rad = 12.0 / kDegPerRad;
constexpr double kOneDistance = 1.25;  // of the farthest view over the nearest
constexpr double kSmall_px = 30.0;
constexpr int kFewTogether = 10;

/// Directions to the camera in the tag's frame, distances, and edges in the image.
struct Places {
  std::set<int> moments;
  std::vector<Eigen::Vector3d> directions;
  std::vector<double> distances_m, edges_px;
};

Places places_of(const MapEvidence& evidence, int tag) {
  Places places;
  for (const MappedView& view : evidence.views) {
    if (view.tag != tag) continue;
    const Eigen::Vector3d camera_in_tag = view.T_camera_tag.inverse().translation();
    places.moments.insert(view.moment);
    places.directions.push_back(camera_in_tag.normalized());
    places.distances_m.push_back(camera_in_tag.norm());
    places.edges_px.push_back(mean_edge_px(view.corners_px));
  }
  return places;
}

double widest_rad(const std::vector<Eigen::Vector3d>& directions, const Eigen::Vector3d& axis) {
  double widest = 0.0;
  for (const Eigen::Vector3d& direction : directions)
    widest = std::max(widest, std::acos(std::clamp(direction.dot(axis), -1.0, 1.0)));
  return widest;
}

std::string angles_in_words(const Places& places) {
  const double off_normal =
      widest_rad(places.directions, -Eigen::Vector3d::UnitZ());  // z points into the tag
  if (off_normal < kHeadOn_rad)
    return fmt::format(", all head-on (within {:.0f} degrees of its normal)",
                       std::max(1.0, std::ceil(off_normal * kDegPerRad)));
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& direction : places.directions) mean += direction;
  const double off_mean = widest_rad(places.directions, mean.normalized());
  if (off_mean < kOneSide_rad)
    return fmt::format(", all from one side (within {:.0f} degrees)",
                       std::max(1.0, std::ceil(off_mean * kDegPerRad)));
  return "";
}

}  // namespace

std::string summary_of_views(const MapEvidence& evidence, int tag, const std::string& neighbour,
                             int frames_together) {
  const Places places = places_of(evidence, tag);
  if (places.moments.empty()) return "no views";
  std::string words =
      fmt::format("{} {}", places.moments.size(), places.moments.size() == 1 ? "frame" : "frames");
  words += angles_in_words(places);
  const auto [nearest, farthest] = std::ranges::minmax(places.distances_m);
  if (farthest < kOneDistance * nearest)
    words += fmt::format(", all from {:.2g} m", upper_median(places.distances_m));
  const double edge_px = upper_median(places.edges_px);
  if (edge_px < kSmall_px) words += fmt::format(", small in them ({:.0f} px)", edge_px);
  if (frames_together < kFewTogether)
    words += fmt::format("; together with {} in {} {}", neighbour, frames_together,
                         frames_together == 1 ? "frame" : "frames");
  return words;
}

}  // namespace apriltrack
