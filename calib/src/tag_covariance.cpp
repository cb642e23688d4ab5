#include "tag_covariance.h"

#include <Eigen/Cholesky>
#include <map>

#include "view_residual.h"

namespace apriltrack {
namespace {

/// The normal equations of one frame: its own block, and its coupling with each tag that it shows.
struct FrameSystem {
  Matrix6d rig_rig = Matrix6d::Zero();
  std::map<int, Matrix6d> tag_rig;
};

/// Position of each tag's six unknowns in the reduced system; the held tag has none.
std::map<int, Eigen::Index> offsets_of(const Part& part, int held_tag) {
  std::map<int, Eigen::Index> offsets;
  for (const int tag : part.tags) {
    if (tag != held_tag) offsets[tag] = 6 * static_cast<Eigen::Index>(offsets.size());
  }
  return offsets;
}

Eigen::MatrixXd reduced_system(const Observations& observations, const Part& part,
                               const std::map<int, Eigen::Index>& offsets, const MapState& state) {
  Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(6 * static_cast<Eigen::Index>(offsets.size()),
                                                  6 * static_cast<Eigen::Index>(offsets.size()));
  std::map<int, FrameSystem> frames;
  for (const std::size_t v : part.views) {
    const TagView& view = observations.views[v];
    Vector8d residual_px;
    Matrix8x6d by_rig, by_tag;
    if (!view_residual(observations.cameras[static_cast<std::size_t>(view.camera)],
                       observations.sizes_m[static_cast<std::size_t>(view.tag)], view.corners_px,
                       state.T_map_rig[static_cast<std::size_t>(view.frame)],
                       state.T_map_tag[static_cast<std::size_t>(view.tag)], &residual_px, &by_rig, &by_tag))
      continue;
    by_rig = view.whitening * by_rig;
    by_tag = view.whitening * by_tag;
    FrameSystem& frame = frames[view.frame];
    frame.rig_rig += by_rig.transpose() * by_rig;
    const auto offset = offsets.find(view.tag);
    if (offset == offsets.end()) continue;
    reduced.block<6, 6>(offset->second, offset->second) += by_tag.transpose() * by_tag;
    frame.tag_rig.try_emplace(view.tag, Matrix6d::Zero()).first->second += by_tag.transpose() * by_rig;
  }
  for (const auto& [index, frame] : frames) {
    const Eigen::LDLT<Matrix6d> rig(frame.rig_rig);
    for (const auto& [tag_a, a_rig] : frame.tag_rig) {
      const Matrix6d eliminated = rig.solve(a_rig.transpose());
      for (const auto& [tag_b, b_rig] : frame.tag_rig)
        reduced.block<6, 6>(offsets.at(tag_b), offsets.at(tag_a)) -= b_rig * eliminated;
    }
  }
  return reduced;
}

}  // namespace

std::optional<std::vector<Matrix6d>> tag_covariances(const Observations& observations, const Part& part,
                                                     int held_tag, const MapState& state) {
  const std::map<int, Eigen::Index> offsets = offsets_of(part, held_tag);
  const Eigen::MatrixXd reduced = reduced_system(observations, part, offsets, state);
  // Metres and radians differ little in size here, but a far tag and a near one do: scale to a unit diagonal.
  const Eigen::VectorXd scale = reduced.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> factor(scale.asDiagonal() * reduced * scale.asDiagonal());
  if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-14)) return std::nullopt;
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(reduced.rows(), reduced.cols()));

  std::vector<Matrix6d> covariances;
  for (const int tag : part.tags) {
    const auto offset = offsets.find(tag);
    if (offset == offsets.end()) {
      covariances.push_back(Matrix6d::Zero());
      continue;
    }
    const auto s = scale.segment<6>(offset->second).asDiagonal();
    const Matrix6d block = s * inverse.block<6, 6>(offset->second, offset->second) * s;
    covariances.push_back(0.5 * (block + block.transpose()));
  }
  return covariances;
}

}  // namespace apriltrack
