#include "uncertainty/viewpoint_shares.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

namespace apriltrack {
namespace {

// As wide as the image of a lamp on paper and print with gloss (bench/worlds draws .03 to .2 rad).
constexpr double kOnePlace_rad = 0.1, kOnePlaceLogDistance = 0.1;

bool are_from_one_place(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double angle_rad = std::atan2(a.cross(b).norm(), a.dot(b));
  return angle_rad < kOnePlace_rad && std::abs(std::log(a.norm() / b.norm())) < kOnePlaceLogDistance;
}

}  // namespace

std::vector<double> viewpoint_shares(const std::vector<Eigen::Vector3d>& lines_of_sight) {
  std::vector<double> shares(lines_of_sight.size());
  std::size_t first = 0;
  for (std::size_t i = 0; i <= lines_of_sight.size(); ++i) {
    if (i < lines_of_sight.size() && are_from_one_place(lines_of_sight[first], lines_of_sight[i])) continue;
    for (std::size_t k = first; k < i; ++k) shares[k] = 1.0 / static_cast<double>(i - first);
    first = i;
  }
  return shares;
}

std::vector<double> viewpoint_shares(const Observations& observations, const MapState& state,
                                     const std::vector<std::size_t>& views) {
  std::map<std::pair<int, int>, std::vector<std::size_t>> of_tag_and_camera;  // places in `views`
  for (std::size_t i = 0; i < views.size(); ++i) {
    const TagView& view = observations.views[views[i]];
    if (view.claimed_px2 > 0.0) of_tag_and_camera[{view.tag, view.camera}].push_back(i);
  }
  std::vector<double> shares(views.size(), 1.0);
  for (const auto& [key, places] : of_tag_and_camera) {
    std::vector<Eigen::Vector3d> lines_of_sight;
    for (const std::size_t i : places) {
      const TagView& view = observations.views[views[i]];
      const Pose T_map_camera = state.T_map_rig[static_cast<std::size_t>(view.frame)] *
                                state.cameras[static_cast<std::size_t>(view.camera)].T_camera_rig.inverse();
      lines_of_sight.push_back(state.T_map_tag[static_cast<std::size_t>(view.tag)].translation() -
                               T_map_camera.translation());
    }
    const std::vector<double> of_places = viewpoint_shares(lines_of_sight);
    for (std::size_t k = 0; k < places.size(); ++k) shares[places[k]] = of_places[k];
  }
  return shares;
}

double mean_viewpoint_share(const Observations& observations, const MapState& state,
                            const std::vector<std::size_t>& views, int tag) {
  std::vector<std::size_t> of_tag;
  std::ranges::copy_if(views, std::back_inserter(of_tag),
                       [&](std::size_t v) { return observations.views[v].tag == tag; });
  if (of_tag.empty()) return 1.0;
  const std::vector<double> shares = viewpoint_shares(observations, state, of_tag);
  return std::reduce(shares.begin(), shares.end()) / static_cast<double>(shares.size());
}

}  // namespace apriltrack
