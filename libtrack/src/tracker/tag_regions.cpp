#include "tag_regions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "apriltrack/tags/tag_corners.h"
#include "place_spread.h"

namespace apriltrack {
namespace {

/// Of the image's area: what all regions together may have, but for the first. At 0.08 the search took a
/// third of a wall's median time.
constexpr double kMaxShare = 0.06;
/// One call of so many looks first where it looked longest ago, whether a tag was read there or not.
constexpr std::uint64_t kCallsByTurn = 4;
/// Beyond, a code is not read (tests of the detector: two thirds of all tags at 1.3 cells).
constexpr double kMaxPathInCells = 1.5;
constexpr double kMinCell_px = 1.2;
/// Standard deviations of the place, and what the library's tiles and a quiet zone need beside.
constexpr double kSigmas = 2.0;
constexpr double kMargin_px = 6.0;

struct Outline {
  Eigen::AlignedBox2d box_px;
  double shortest_edge_px = 0.0;
  double path_px = 0.0;
};

/// A tag's printed square in the middle of the exposure; nullopt where it is not seen.
std::optional<Outline> outline(const CameraModel& model, const PhotometricTag& tag, const MotionState& state,
                               double exposure_s, TrackMode mode) {
  const auto view_at = [&](double time_s) {
    return camera_from_map(pose_after(state, time_s), mode) * tag.tag.T_map_tag;
  };
  const Pose view = view_at(0.0);
  if (!(view.translation().z() > tag.half_size_m())) return std::nullopt;
  if (!((view.rotation() * Eigen::Vector3d::UnitZ()).dot(view.translation()) > 0.0)) return std::nullopt;
  const Pose first = view_at(-0.5 * exposure_s), last = view_at(0.5 * exposure_s);
  Outline outline;
  outline.shortest_edge_px = std::numeric_limits<double>::infinity();
  const auto corners = tag_corners(tag.tag.size_m);
  std::array<Eigen::Vector2d, kNumCorners> pixels;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto pixel = model.project(view * corners[i]);
    const auto margin = model.project(view * (tag.half_extent * corners[i]));
    const auto from = model.project(first * corners[i]), to = model.project(last * corners[i]);
    if (!pixel || !margin || !from || !to) return std::nullopt;
    pixels[i] = *pixel;
    outline.box_px.extend(*margin);
    outline.path_px = std::max(outline.path_px, (*to - *from).norm());
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const double edge_px = (pixels[(i + 1) % kNumCorners] - pixels[i]).norm();
    outline.shortest_edge_px = std::min(outline.shortest_edge_px, edge_px);
  }
  return outline;
}

/// The pixels of the box, widened, that lie in the image; empty where none does.
ImageRegion region_in_image(const Eigen::AlignedBox2d& box_px, double margin_px, int width, int height) {
  const auto clamped = [](double value, int limit) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
  };
  const int x0 = clamped(std::floor(box_px.min().x() - margin_px), width);
  const int y0 = clamped(std::floor(box_px.min().y() - margin_px), height);
  const int x1 = clamped(std::ceil(box_px.max().x() + margin_px), width);
  const int y1 = clamped(std::ceil(box_px.max().y() + margin_px), height);
  return {x0, y0, x1 - x0, y1 - y0};
}

double area_of(const ImageRegion& region) {
  return static_cast<double>(region.width) * static_cast<double>(region.height);
}

}  // namespace

std::vector<TagRegion> TagRegions::choose(PhotometricWorld& world, const MotionBelief& expected,
                                          double exposure_s, int width, int height) {
  ++num_calls_;
  std::vector<Place> places = readable_places(world, expected, exposure_s, width, height);
  const bool is_by_turn = num_calls_ % kCallsByTurn == 0;
  std::ranges::stable_sort(places, [&](const Place& a, const Place& b) {
    const Looked &at_a = looked_[a.tag_index], &at_b = looked_[b.tag_index];
    if (!is_by_turn && at_a.was_read != at_b.was_read) return at_a.was_read;
    return at_a.last < at_b.last;
  });
  std::vector<TagRegion> regions;
  double left = kMaxShare * width * height;
  for (const Place& place : places) {
    if (!regions.empty() && area_of(place.region) > left) continue;
    regions.push_back({place.region, world.tags[place.tag_index].tag.key.family});
    left -= area_of(place.region);
    looked_[place.tag_index].last = num_calls_;
  }
  return regions;
}

void TagRegions::were_read(const std::vector<TagObservation>& observations) {
  for (const TagObservation& seen : observations)
    looked_[static_cast<std::size_t>(seen.tag_index)].was_read = true;
}

std::vector<TagRegions::Place> TagRegions::readable_places(PhotometricWorld& world,
                                                           const MotionBelief& expected, double exposure_s,
                                                           int width, int height) const {
  std::vector<Place> places;
  const Eigen::AlignedBox2d image(Eigen::Vector2d(0, 0), Eigen::Vector2d(width - 1, height - 1));
  for (const std::size_t i : world.tags_in_sight(expected.mean)) {
    const PhotometricTag& tag = world.tags[i];
    const auto seen = outline(world.model, tag, expected.mean, exposure_s, world.mode);
    if (!seen || !image.intersects(seen->box_px)) continue;
    const double cell_px = 0.5 * world.textures.pattern(tag.index).cell_size() * seen->shortest_edge_px;
    if (cell_px < kMinCell_px || seen->path_px > kMaxPathInCells * cell_px) continue;
    const double margin_px = kMargin_px + kSigmas * place_sigma_px(world, tag, expected.mean.pose,
                                                                   expected.covariance.topLeftCorner<6, 6>());
    places.push_back({i, region_in_image(seen->box_px, margin_px, width, height)});
  }
  return places;
}

}  // namespace apriltrack
