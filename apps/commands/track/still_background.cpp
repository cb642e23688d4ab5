#include "still_background.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "apriltrack/base/degrees.h"

namespace apriltrack::app {
namespace {

constexpr int kSmaller = 4;      // than the picture: noise averages out
constexpr int kPiece = 8;        // pixels of the small picture across a piece
constexpr double kTurned = 5.0;  // degrees: tens of pixels, at any focal length that sees tags
constexpr double kTurnedFar = 25.0;
constexpr double kLongAgo_s = 1.0;

Image<float> reduced_by_mean(const GrayView& image) {
  Image<float> small(std::max(1, image.width() / kSmaller), std::max(1, image.height() / kSmaller));
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      int sum = 0;
      for (int v = 0; v < kSmaller && kSmaller * y + v < image.height(); ++v)
        for (int u = 0; u < kSmaller && kSmaller * x + u < image.width(); ++u)
          sum += image(kSmaller * x + u, kSmaller * y + v);
      small(x, y) = static_cast<float>(sum) / (kSmaller * kSmaller);
    }
  }
  return small;
}

/// What is left of a piece without its mean and its slope, which light makes, not texture.
Eigen::VectorXd texture_of(const Image<float>& small, int column, int row) {
  constexpr int kCount = kPiece * kPiece;
  Eigen::VectorXd values(kCount), across(kCount), down(kCount);
  for (int i = 0; i < kCount; ++i) {
    across[i] = i % kPiece - 0.5 * (kPiece - 1);
    down[i] = i / kPiece - 0.5 * (kPiece - 1);
    values[i] = small(kPiece * column + i % kPiece, kPiece * row + i / kPiece);
  }
  values.array() -= values.mean();
  values -= across * (across.dot(values) / across.squaredNorm());
  values -= down * (down.dot(values) / down.squaredNorm());
  return values;
}

/// Whether it reaches into what no light falls on: beside a fisheye's circle, or beyond the edge of a
/// rectified picture. Such edges are the camera's own, and stand still.
bool has_unlit_pixels(const Image<float>& small, int column, int row) {
  constexpr float kUnlit = 1.0F;  // grey levels, mean of a small picture's pixel
  for (int i = 0; i < kPiece * kPiece; ++i)
    if (small(kPiece * column + i % kPiece, kPiece * row + i / kPiece) < kUnlit) return true;
  return false;
}

/// A tag, and as much again round it, for it hangs on something that moves with it.
struct HiddenDisc {
  Eigen::Vector2d center_px;
  double radius_px;
};

std::vector<HiddenDisc> discs_of(const TagMap& map, const Camera& camera, const Pose& T_world_camera) {
  std::vector<HiddenDisc> discs;
  const Pose T_camera_world = T_world_camera.inverse();
  for (const MapTag& tag : map.tags) {
    const Eigen::Vector3d center = T_camera_world * tag.T_map_tag.translation();
    const auto pixel = center.z() > 0.0 ? camera.model.project(center) : std::nullopt;
    if (pixel) discs.push_back({*pixel, 1.5 * camera.model.pinhole().fx * tag.size_m / center.z()});
  }
  return discs;
}

double turned_degrees(const Pose& a, const Pose& b) {
  const Eigen::Vector3d ahead_a = a.rotation() * Eigen::Vector3d::UnitZ(),
                        ahead_b = b.rotation() * Eigen::Vector3d::UnitZ();
  return kDegPerRad * std::atan2(ahead_a.cross(ahead_b).norm(), ahead_a.dot(ahead_b));
}

}  // namespace

StillBackground::Reference StillBackground::reference(Timestamp time, const GrayView& image,
                                                      const Pose& T_world_camera) const {
  Reference made{time, T_world_camera, reduced_by_mean(image), {}};
  const std::vector<HiddenDisc> discs = discs_of(map_, camera_, T_world_camera);
  constexpr double kPiece_px = kSmaller * kPiece;
  for (int row = 0; row < made.small.height() / kPiece; ++row) {
    for (int column = 0; column < made.small.width() / kPiece; ++column) {
      const Eigen::Vector2d middle = kPiece_px * Eigen::Vector2d(column + 0.5, row + 0.5);
      made.is_hidden.push_back(has_unlit_pixels(made.small, column, row) ||
                               std::ranges::any_of(discs, [&](const HiddenDisc& disc) {
                                 return (disc.center_px - middle).norm() < disc.radius_px + kPiece_px;
                               }));
    }
  }
  return made;
}

void StillBackground::compare(const Reference& before, const Reference& now) {
  constexpr double kTextured = 3.0;  // grey levels, root mean square
  constexpr double kSame = 0.9;      // correlation
  if (before.is_hidden.size() != now.is_hidden.size()) return;
  ++pairs_;
  const int columns = now.small.width() / kPiece;
  for (std::size_t i = 0; i < now.is_hidden.size(); ++i) {
    if (before.is_hidden[i] || now.is_hidden[i]) continue;
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    const Eigen::VectorXd a = texture_of(before.small, column, row), b = texture_of(now.small, column, row);
    if (std::min(a.norm(), b.norm()) < kTextured * kPiece) continue;
    ++textured_;
    still_ += a.dot(b) > kSame * a.norm() * b.norm();
  }
}

void StillBackground::add(Timestamp time, const GrayView& image, const Pose& T_world_camera) {
  constexpr std::size_t kEnoughPairs = 30;
  if (pairs_ >= kEnoughPairs) return;
  if (last_) {
    const double turned = turned_degrees(last_->T_world_camera, T_world_camera);
    const bool is_too_far = turned > kTurnedFar || seconds_between(last_->time, time) > kLongAgo_s;
    if (!is_too_far && turned < kTurned) return;
    Reference now = reference(time, image, T_world_camera);
    if (!is_too_far) compare(*last_, now);
    last_ = std::move(now);
  } else {
    last_ = reference(time, image, T_world_camera);
  }
}

std::optional<std::string> StillBackground::told() const {
  constexpr std::size_t kLeastPairs = 3, kLeastPieces = 30;
  constexpr double kMost = 0.3;  // 65 to 88 % of films of bodies, 0.3 to 1.4 % of films of rooms
  if (pairs_ < kLeastPairs || textured_ < kLeastPieces) return std::nullopt;
  if (static_cast<double>(still_) < kMost * static_cast<double>(textured_)) return std::nullopt;
  return fmt::format(
      "what lies beside the tags stands still in the pictures ({:.0f} % of {} pieces with texture) while the "
      "poses turn "
      "by {:g} degrees and more: the camera rests, and the tags move before it. The poses of --mode ego are "
      "those of a "
      "camera that moves round the tags; with --mode joint they are T_camera_body",
      100.0 * static_cast<double>(still_) / static_cast<double>(textured_), textured_, kTurned);
}

}  // namespace apriltrack::app
