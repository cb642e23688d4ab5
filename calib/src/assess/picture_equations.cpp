#include "assess/picture_equations.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>

#include "apriltrack/geometry/tag_view.h"
#include "model/corner_views.h"

namespace apriltrack {
namespace {

constexpr double kLeastCosine = 0.42;  // 65 degrees
constexpr double kLeastEdge_px = 18.0;
constexpr double kMarginOfImage = 0.02;

std::optional<CornersPx> visible_corners(const CameraModel& lens, int width, int height,
                                         const Pose& T_camera_tag, double size_m) {
  if (tag_view_cosine(T_camera_tag) < kLeastCosine) return std::nullopt;
  const double margin_px = kMarginOfImage * std::max(width, height);
  CornersPx corners;
  const auto points = tag_corners(size_m);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto pixel = lens.project(T_camera_tag * points[i]);
    if (!pixel || !(pixel->x() > margin_px && pixel->y() > margin_px && pixel->x() < width - margin_px &&
                    pixel->y() < height - margin_px))
      return std::nullopt;
    corners[i] = *pixel;
  }
  if (mean_edge_px(corners) < kLeastEdge_px) return std::nullopt;
  return corners;
}

struct SeenTag {
  Eigen::Index place = 0;
  CornersPx corners;
  double from_center_px = 0.0;
};

Eigen::Vector2d middle_of(const CornersPx& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

std::vector<SeenTag> tags_in_view(const PictureScene& scene, const Pose& T_map_camera,
                                  const std::vector<Eigen::Index>& made_for) {
  const Pose T_camera_map = T_map_camera.inverse();
  const Eigen::Vector2d center(0.5 * scene.width, 0.5 * scene.height);
  std::vector<SeenTag> seen;
  for (std::size_t i = 0; i < scene.tags.size(); ++i) {
    const MapTag& tag = scene.tags[i];
    const auto corners =
        visible_corners(scene.lens, scene.width, scene.height, T_camera_map * tag.T_map_tag, tag.size_m);
    if (!corners) continue;
    const auto place = static_cast<Eigen::Index>(i);
    const bool is_wanted = std::ranges::find(made_for, place) != made_for.end();
    seen.push_back({place, *corners, is_wanted ? 0.0 : (middle_of(*corners) - center).norm()});
  }
  if (seen.size() > scene.most_tags) {
    std::ranges::stable_sort(seen, {}, &SeenTag::from_center_px);
    seen.resize(scene.most_tags);
    std::ranges::sort(seen, {}, &SeenTag::place);
  }
  return seen;
}

/// One moment of one camera, as the adjustment would see it.
struct Picture {
  Observations observations;
  MapState state;
  std::vector<Eigen::Index> tags;
};

Picture picture_of(const PictureScene& scene, const Pose& T_map_camera,
                   const std::vector<Eigen::Index>& made_for) {
  Picture picture;
  Observations& seen = picture.observations;
  seen.cameras.push_back({scene.lens, Pose::identity(), 0.0});
  seen.frames.emplace_back();
  for (const SeenTag& one : tags_in_view(scene, T_map_camera, made_for)) {
    const MapTag& tag = scene.tags[static_cast<std::size_t>(one.place)];
    seen.views.push_back(
        {static_cast<int>(seen.tags.size()), 0, 0, one.corners,
         edge_noise_whitening(one.corners, {scene.noise.sigma_px, scene.noise.end_correlation}),
         Vector8d::Zero()});
    seen.tags.push_back(tag.key);
    seen.sizes_m.push_back(tag.size_m);
    picture.state.T_map_tag.push_back(tag.T_map_tag);
    picture.tags.push_back(one.place);
  }
  picture.state.cameras = seen.cameras;
  picture.state.T_map_rig = {T_map_camera};
  picture.state.noise = {scene.noise.sum_scale, scene.noise.difference_scale};
  return picture;
}

}  // namespace

PictureScene::PictureScene(const TagMap& map, const JointCovariance& joint, const CornerNoise& corner_noise,
                           const Camera& camera)
    : noise(corner_noise),
      lens(camera.model),
      width(camera.width > 0 ? camera.width : static_cast<int>(2.0 * lens.pinhole().cx)),
      height(camera.height > 0 ? camera.height : static_cast<int>(2.0 * lens.pinhole().cy)),
      are_errors_of_corners(joint.are_errors_of_corners) {
  for (const TagKey& key : joint.tags) tags.push_back(*map.find(key));
}

PictureEquations picture_equations(const PictureScene& scene, const Pose& T_map_camera,
                                   const std::vector<Eigen::Index>& made_for) {
  const Picture picture = picture_of(scene, T_map_camera, made_for);
  std::vector<std::size_t> numbers(picture.tags.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
  const std::vector<LinearView> views = corner_views(picture.observations, numbers, picture.state);
  PictureEquations result;
  for (const LinearView& view : views)  // of those that the lens shows, which all should be
    result.tags.push_back(picture.tags[static_cast<std::size_t>(view.tag)]);
  if (result.tags.size() < 2) return result;
  const auto num = static_cast<Eigen::Index>(views.size());
  Eigen::MatrixXd by_rig(8 * num, 6);
  Eigen::MatrixXd others = Eigen::MatrixXd::Zero(8 * num, 14 * num);  // by the poses, by the errors
  for (Eigen::Index i = 0; i < num; ++i) {
    const LinearView& view = views[static_cast<std::size_t>(i)];
    by_rig.middleRows<8>(8 * i) = view.by_rig;
    others.block<8, 6>(8 * i, 6 * i) = view.by_tag;
    auto errors = others.block<8, 8>(8 * i, 6 * num + 8 * i);
    errors = view.by_error;
    if (scene.are_errors_of_corners)
      errors *= picture.observations.views[static_cast<std::size_t>(view.tag)].whitening;
  }
  // What is at right angles to all that the camera's pose can explain.
  const Eigen::HouseholderQR<Eigen::MatrixXd> by_pose(by_rig);
  others.applyOnTheLeft(by_pose.householderQ().adjoint());
  result.G = others.bottomLeftCorner(8 * num - 6, 6 * num);
  result.E = others.bottomRightCorner(8 * num - 6, 8 * num);
  return result;
}

JointUpdate::JointUpdate(const JointCovariance& joint, const PictureEquations& picture, int pictures)
    : joint_(joint), G_(picture.G), E_(joint.bias_sigma * picture.E) {
  for (const Eigen::Index tag : picture.tags) {
    rows_.push_back(6 * tag);
    columns_.push_back(8 * tag);
  }
  const auto num = static_cast<Eigen::Index>(rows_.size());
  Eigen::MatrixXd covariance(6 * num, 6 * num);
  for (Eigen::Index a = 0; a < num; ++a) {
    for (Eigen::Index b = 0; b < num; ++b)
      covariance.block<6, 6>(6 * a, 6 * b) =
          joint.by_noise.block<6, 6>(rows_[static_cast<std::size_t>(a)], rows_[static_cast<std::size_t>(b)]);
  }
  Eigen::MatrixXd M = G_ * covariance * G_.transpose();
  M.diagonal().array() += joint.noise_variance / pictures;
  projector_ = M.llt().solve(G_).transpose();
}

void JointUpdate::correct(const Eigen::MatrixXd& gain, Eigen::MatrixXd& by_errors) const {
  const Eigen::MatrixXd by_poses = gain * G_, by_own = gain * E_;
  for (std::size_t a = 0; a < rows_.size(); ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    by_errors -= by_poses.middleCols<6>(6 * i) * joint_.by_errors.middleRows<6>(rows_[a]);
    by_errors.middleCols<8>(columns_[a]) -= by_own.middleCols<8>(8 * i);
  }
}

Matrix6d JointUpdate::covariance_of(Eigen::Index tag) const {
  Eigen::MatrixXd with_visible(6, G_.cols());
  for (std::size_t a = 0; a < rows_.size(); ++a)
    with_visible.middleCols<6>(6 * static_cast<Eigen::Index>(a)) =
        joint_.by_noise.block<6, 6>(6 * tag, rows_[a]);
  const Eigen::MatrixXd gain = with_visible * projector_;
  Eigen::MatrixXd by_errors = joint_.by_errors.middleRows<6>(6 * tag);
  correct(gain, by_errors);
  return joint_.by_noise.block<6, 6>(6 * tag, 6 * tag) - gain * G_ * with_visible.transpose() +
         by_errors * by_errors.transpose();
}

JointCovariance JointUpdate::updated() const {
  Eigen::MatrixXd with_visible(joint_.by_noise.rows(), G_.cols());
  for (std::size_t a = 0; a < rows_.size(); ++a)
    with_visible.middleCols<6>(6 * static_cast<Eigen::Index>(a)) = joint_.by_noise.middleCols<6>(rows_[a]);
  const Eigen::MatrixXd gain = with_visible * projector_;
  JointCovariance result = joint_;
  result.by_noise -= gain * G_ * with_visible.transpose();
  result.by_noise = 0.5 * (result.by_noise + result.by_noise.transpose()).eval();
  correct(gain, result.by_errors);
  return result;
}

}  // namespace apriltrack
