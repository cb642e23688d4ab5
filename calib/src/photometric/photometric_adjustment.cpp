#include "photometric/photometric_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

#include "apriltrack/camera/pixel_jacobian.h"
#include "apriltrack/tags/tag_corners.h"
#include "numerics/upper_median.h"
#include "observations/tags_that_hang_together.h"
#include "solve/reduced_equations.h"

namespace apriltrack {
namespace {

/// Squared standard deviations per unknown, of noise alone: nobody sees a smaller step.
constexpr double kSettledWorth = 0.02;
/// What a slow adjustment may leave, as all of its steps together are soon less than a standard deviation.
constexpr double kNearlySettled = 0.5;
/// Steps before views that disagree with all others are dropped.
constexpr int kStepsBeforeOutliers = 4;
constexpr double kLeastPsf_px = 0.1, kMostPsf_px = 3.0;

using ByCorners = Eigen::Matrix<double, 6, 8>;

/// The left perturbation of T_camera_tag that fits errors of the tag's corners in the image best, by these.
std::optional<ByCorners> pose_by_corners(const CameraModel& camera, const Pose& T_camera_tag, double size_m) {
  Eigen::Matrix<double, 8, 6> corners_by_pose;
  int row = 0;
  for (const Eigen::Vector3d& corner_tag : tag_corners(size_m)) {
    const Eigen::Vector3d corner = T_camera_tag * corner_tag;
    Eigen::Matrix<double, 2, 3> by_point;
    if (!camera.project(corner, &by_point)) return std::nullopt;
    corners_by_pose.middleRows<2>(row) = pixel_jacobian(by_point, corner);
    row += 2;
  }
  const Matrix6d normal = corners_by_pose.transpose() * corners_by_pose;
  return ByCorners(normal.ldlt().solve(corners_by_pose.transpose()));
}

}  // namespace

void put_tag(int tag, const Pose& T_map_tag, PhotometricState& state) {
  const Pose& from = state.T_map_tag[static_cast<std::size_t>(tag)];
  if (from.matrix() == T_map_tag.matrix()) return;
  const Pose move = T_map_tag * from.inverse();
  for (Pose& pose : state.T_map_tag) pose = move * pose;
  for (Pose& pose : state.T_map_rig) pose = move * pose;
  state.T_map_tag[static_cast<std::size_t>(tag)] = T_map_tag;
}

/// A view that is explained, with its equations.
struct PhotometricAdjustment::SeenView {
  std::size_t view = 0;
  ViewEquations equations;
  LinearView linear;

  double disagreement2() const { return linear.residual.squaredNorm(); }
};

PhotometricAdjustment::PhotometricAdjustment(const PhotometricScene& scene, PhotometricState state,
                                             ParallelFor parallel)
    : scene_(scene),
      state_(std::move(state)),
      parallel_(std::move(parallel)),
      takes_part_(scene.views.size(), true) {}

void PhotometricAdjustment::choose_moments(const std::vector<bool>& is_chosen) {
  for (std::size_t v = 0; v < takes_part_.size(); ++v)
    takes_part_[v] = is_chosen[static_cast<std::size_t>(scene_.views[v].moment)];
}

Pose PhotometricAdjustment::T_camera_tag(const PhotometricView& view) const {
  return scene_.T_camera_rig[static_cast<std::size_t>(view.camera)] *
         state_.T_map_rig[static_cast<std::size_t>(view.moment)].inverse() *
         state_.T_map_tag[static_cast<std::size_t>(view.tag)];
}

/// Of each tag side by side, so that its light adds up in one order.
std::vector<PhotometricAdjustment::SeenView> PhotometricAdjustment::look(bool is_light_free, Pixels pixels) {
  std::vector<std::vector<std::size_t>> views_of_tag(scene_.tags.size());
  for (std::size_t v = 0; v < scene_.views.size(); ++v) {
    if (takes_part_[v]) views_of_tag[static_cast<std::size_t>(scene_.views[v].tag)].push_back(v);
  }
  std::vector<std::optional<SeenView>> found(scene_.views.size());
  parallel_(scene_.tags.size(), [&](std::size_t tag) {
    TagLight::Sums sums(state_.lights[tag]);
    for (const std::size_t v : views_of_tag[tag]) {
      const PhotometricView& view = scene_.views[v];
      const auto camera = static_cast<std::size_t>(view.camera);
      const Pose T_ct = T_camera_tag(view);
      const auto equations = view_equations(view, scene_.cameras[camera].model, scene_.tags[tag], T_ct,
                                            state_.psf_sigma_px[camera], state_.lights[tag], sums, pixels);
      if (!equations) continue;
      const Eigen::LLT<Matrix6d> factor(equations->H.topLeftCorner<6, 6>());
      const auto by_corners =
          pose_by_corners(scene_.cameras[camera].model, T_ct, 2.0 * scene_.tags[tag].half_size_m);
      if (factor.info() != Eigen::Success || !by_corners) continue;
      const Matrix6d whitening = factor.matrixU();
      found[v] = SeenView{
          v,
          *equations,
          {view.tag, view.moment, view.camera,
           LinearView::Residual(factor.matrixL().solve(equations->g.head<6>())),
           LinearView::ByPose(-whitening * scene_.T_camera_rig[camera].adjoint()),
           LinearView::ByPose(whitening * T_ct.adjoint()), LinearView::ByError(whitening * *by_corners)}};
    }
    if (is_light_free) state_.lights[tag].update(sums);
  });
  std::vector<SeenView> seen;
  for (std::optional<SeenView>& one : found) {
    if (one) seen.push_back(std::move(*one));
  }
  return seen;
}

/// A hand over half a tag looks like a tag that is elsewhere.
void PhotometricAdjustment::drop_outliers(const std::vector<SeenView>& seen) {
  if (seen.empty()) return;
  std::vector<double> disagreements;
  for (const SeenView& one : seen) disagreements.push_back(one.disagreement2());
  const double most = kOutlierOfMedian2 * upper_median(std::move(disagreements));
  for (const SeenView& one : seen) {
    if (one.disagreement2() > most) takes_part_[one.view] = false;
  }
}

void PhotometricAdjustment::keep_hanging_together(int wanted_tag, std::vector<LinearView>& views) {
  std::vector<TagAtMoment> seen;
  for (const LinearView& view : views) seen.push_back({view.tag, view.frame});
  const HangingTogether together = tags_that_hang_together(seen, wanted_tag);
  held_tag_ = together.held_tag;
  is_solved_.assign(scene_.tags.size(), false);
  std::vector<LinearView> kept;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!together.is_in[i]) continue;
    is_solved_[static_cast<std::size_t>(views[i].tag)] = true;
    kept.push_back(std::move(views[i]));
  }
  views = std::move(kept);
}

/// Which tag is held may have changed on the way.
void PhotometricAdjustment::restore_unsolved(const PhotometricState& before) {
  if (held_tag_ < 0) return;
  put_tag(held_tag_, before.T_map_tag[static_cast<std::size_t>(held_tag_)], state_);
  for (std::size_t tag = 0; tag < is_solved_.size(); ++tag) {
    if (!is_solved_[tag]) state_.T_map_tag[tag] = before.T_map_tag[tag];
  }
}

bool PhotometricAdjustment::step(const PhotometricFreedom& freedom, Pixels pixels, double* worth) {
  const std::vector<SeenView> seen = look(freedom.is_light_free, pixels);
  std::vector<LinearView> linear;
  std::vector<Eigen::Vector2d> psf(scene_.cameras.size(), Eigen::Vector2d::Zero());  // push, weight
  for (const SeenView& one : seen) {
    linear.push_back(one.linear);
    psf[static_cast<std::size_t>(one.linear.camera)] +=
        Eigen::Vector2d(one.equations.g[6], one.equations.H(6, 6));
  }
  if (freedom.held_tag) keep_hanging_together(*freedom.held_tag, linear);
  if (freedom.held_tag && linear.empty()) return false;
  const auto steps = solve_steps(linear, freedom.held_tag ? std::optional(held_tag_) : std::nullopt);
  if (!steps) return false;
  for (const auto& [tag, step] : steps->tags) {
    Pose& pose = state_.T_map_tag[static_cast<std::size_t>(tag)];
    pose = pose * Pose::exp(step);
  }
  for (const auto& [moment, step] : steps->frames) {
    Pose& pose = state_.T_map_rig[static_cast<std::size_t>(moment)];
    pose = pose * Pose::exp(step);
  }
  for (std::size_t c = 0; freedom.is_light_free && c < psf.size(); ++c) {
    if (psf[c][1] > 0.0)
      state_.psf_sigma_px[c] =
          std::clamp(state_.psf_sigma_px[c] - psf[c][0] / psf[c][1], kLeastPsf_px, kMostPsf_px);
  }
  *worth = steps->worth;
  return true;
}

std::optional<double> PhotometricAdjustment::settle(const PhotometricFreedom& freedom, Pixels pixels,
                                                    int max_steps) {
  const bool is_first = pixels == Pixels::kCoarse;
  double worth = 0.0;
  for (int done = 1; done <= max_steps; ++done) {
    if (!step(freedom, pixels, &worth)) return std::nullopt;
    if (is_first && done == kStepsBeforeOutliers) drop_outliers(look(false, pixels));
    if (worth < kSettledWorth && !(is_first && done <= 2 * kStepsBeforeOutliers)) break;
  }
  return worth;
}

bool PhotometricAdjustment::run(const PhotometricFreedom& freedom, int max_steps) {
  const PhotometricState before = state_;
  std::optional<double> worth;
  for (const Pixels pixels : {Pixels::kCoarse, Pixels::kAll}) {
    worth = settle(freedom, pixels, max_steps);
    if (!worth) {
      state_ = before;
      return false;
    }
  }
  if (freedom.held_tag) restore_unsolved(before);
  return *worth < kNearlySettled;
}

std::vector<LinearView> PhotometricAdjustment::linear_views() {
  const bool have_tags_moved = held_tag_ >= 0;
  std::vector<LinearView> linear;
  for (SeenView& one : look(false, Pixels::kAll)) {
    if (!have_tags_moved || is_solved_[static_cast<std::size_t>(one.linear.tag)])
      linear.push_back(std::move(one.linear));
  }
  if (have_tags_moved) keep_hanging_together(held_tag_, linear);
  return linear;
}

std::vector<std::optional<double>> PhotometricAdjustment::disagreements2() {
  std::vector<std::optional<double>> squares(scene_.views.size());
  for (const SeenView& one : look(false, Pixels::kAll)) squares[one.view] = one.disagreement2();
  return squares;
}

}  // namespace apriltrack
