#include "tag_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <utility>

namespace apriltrack {
namespace {

using Matrix6x8d = Eigen::Matrix<double, 6, 8>;

/// The normal equations of one frame: its own block, and for each tag that it shows their coupling and the
/// frame's sensitivity to errors of that tag.
struct FrameSystem {
  struct OfTag {
    Matrix6d tag_rig = Matrix6d::Zero();
    Matrix6x8d rig_errors = Matrix6x8d::Zero();
  };
  Matrix6d rig_rig = Matrix6d::Zero();
  std::map<int, OfTag> tags;
};

/// What is left of the normal equations when the frames are eliminated: reduced * xi = sum_k errors[k] e_k
/// for whitened errors e_k that tag k has in all of its views.
struct ReducedSystem {
  Eigen::MatrixXd reduced;
  std::map<int, std::map<Eigen::Index, Matrix6x8d>> errors;  ///< By tag, then by offset in the system.
};

/// Position of each tag's six unknowns in the reduced system; the held tag has none.
std::map<int, Eigen::Index> offsets_of(const std::vector<int>& tags, int held_tag) {
  std::map<int, Eigen::Index> offsets;
  for (const int tag : tags) {
    if (tag != held_tag) offsets[tag] = 6 * static_cast<Eigen::Index>(offsets.size());
  }
  return offsets;
}

void eliminate(const FrameSystem& frame, const std::map<int, Eigen::Index>& offsets, ReducedSystem& system) {
  const Eigen::LDLT<Matrix6d> rig(frame.rig_rig);
  for (const auto& [tag_a, a] : frame.tags) {
    const auto offset_a = offsets.find(tag_a);
    if (offset_a == offsets.end()) continue;
    const Matrix6d eliminated = rig.solve(a.tag_rig.transpose()).transpose();
    for (const auto& [tag_b, b] : frame.tags) {
      const auto to = system.errors[tag_b].try_emplace(offset_a->second, Matrix6x8d::Zero()).first;
      to->second -= eliminated * b.rig_errors;
      const auto offset_b = offsets.find(tag_b);
      if (offset_b == offsets.end()) continue;
      system.reduced.block<6, 6>(offset_a->second, offset_b->second) -= eliminated * b.tag_rig.transpose();
    }
  }
}

ReducedSystem reduced_system(const std::vector<LinearView>& views,
                             const std::map<int, Eigen::Index>& offsets) {
  const auto size = 6 * static_cast<Eigen::Index>(offsets.size());
  ReducedSystem system{Eigen::MatrixXd::Zero(size, size), {}};
  std::map<int, FrameSystem> frames;
  for (const LinearView& view : views) {
    FrameSystem& frame = frames[view.frame];
    frame.rig_rig += view.by_rig.transpose() * view.by_rig;
    FrameSystem::OfTag& of_tag = frame.tags[view.tag];
    of_tag.rig_errors += view.by_rig.transpose() * view.by_error;
    of_tag.tag_rig += view.by_tag.transpose() * view.by_rig;
    const auto offset = offsets.find(view.tag);
    if (offset == offsets.end()) continue;
    system.reduced.block<6, 6>(offset->second, offset->second) += view.by_tag.transpose() * view.by_tag;
    system.errors[view.tag].try_emplace(offset->second, Matrix6x8d::Zero()).first->second +=
        view.by_tag.transpose() * view.by_error;
  }
  for (const auto& [index, frame] : frames) eliminate(frame, offsets, system);
  return system;
}

Matrix6d symmetric(const Matrix6d& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

/// rows: those of the inverse that belong to the tags from offset `first` on.
std::vector<TagCovariance> covariances_from(const ReducedSystem& system, const Eigen::MatrixXd& rows,
                                            Eigen::Index first) {
  std::vector<TagCovariance> covariances(static_cast<std::size_t>(rows.rows() / 6));
  Eigen::MatrixXd d_poses_d_error(rows.rows(), 8);
  for (const auto& [tag, errors] : system.errors) {
    d_poses_d_error.setZero();
    for (const auto& [column, block] : errors) d_poses_d_error += rows.middleCols<6>(column) * block;
    for (std::size_t i = 0; i < covariances.size(); ++i) {
      const Matrix6x8d own = d_poses_d_error.middleRows<6>(6 * static_cast<Eigen::Index>(i));
      covariances[i].by_bias += own * own.transpose();
    }
  }
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(i);
    covariances[i].by_noise = symmetric(rows.block<6, 6>(row, first + row));
    covariances[i].by_bias = symmetric(covariances[i].by_bias);
  }
  return covariances;
}

}  // namespace

std::optional<std::vector<TagCovariance>> tag_covariances(const std::vector<LinearView>& views,
                                                          const std::vector<int>& tags, int held_tag) {
  const std::map<int, Eigen::Index> offsets = offsets_of(tags, held_tag);
  ReducedSystem system = reduced_system(views, offsets);
  // Metres and radians differ little in size here, but a far tag and a near one do: scale to a unit diagonal.
  const Eigen::VectorXd scale = system.reduced.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  system.reduced.array().colwise() *= scale.array();
  system.reduced.array().rowwise() *= scale.transpose().array();
  // In place: of many tags this matrix is large.
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(system.reduced);
  if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-14)) return std::nullopt;

  const Eigen::Index size = scale.size();
  constexpr Eigen::Index kTagsAtOnce = 16;  // of the inverse: few enough to be small, enough to be fast
  std::map<Eigen::Index, TagCovariance> by_offset;
  for (Eigen::Index first = 0; first < size; first += 6 * kTagsAtOnce) {
    const Eigen::Index width = std::min(6 * kTagsAtOnce, size - first);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size, width);
    columns.middleRows(first, width).diagonal() = scale.segment(first, width);
    factor.solveInPlace(columns);
    columns.array().colwise() *= scale.array();
    const Eigen::MatrixXd rows = columns.transpose();  // the inverse is symmetric
    Eigen::Index offset = first;
    for (TagCovariance& covariance : covariances_from(system, rows, first)) {
      by_offset[offset] = std::move(covariance);
      offset += 6;
    }
  }

  std::vector<TagCovariance> covariances;
  for (const int tag : tags) {
    const auto offset = offsets.find(tag);
    covariances.push_back(offset == offsets.end() ? TagCovariance{} : by_offset.at(offset->second));
  }
  return covariances;
}

}  // namespace apriltrack
