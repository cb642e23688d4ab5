#include "uncertainty/pose_information.h"

#include <algorithm>
#include <utility>

namespace apriltrack {
namespace {

using Matrix6x8d = PoseInformation::Matrix6x8d;

void add(PoseInformation::Blocks& blocks, Eigen::Index offset, const Matrix6x8d& block) {
  blocks.try_emplace(offset, Matrix6x8d::Zero()).first->second += block;
}

}  // namespace

std::vector<ParameterView> beside(std::vector<ParameterView> some, const std::vector<ParameterView>& more) {
  if (some.empty() || more.empty()) return some.empty() ? more : some;
  for (std::size_t i = 0; i < some.size(); ++i) {
    Eigen::MatrixXd both(some[i].by_parameter.rows(),
                         some[i].by_parameter.cols() + more[i].by_parameter.cols());
    both << some[i].by_parameter, more[i].by_parameter;
    some[i].by_parameter = std::move(both);
  }
  return some;
}

std::optional<PoseInformation> PoseInformation::of(const std::vector<LinearView>& views,
                                                   const std::vector<int>& tags, int held_tag) {
  PoseInformation information(views);
  information.number_tags(tags, held_tag);
  Eigen::MatrixXd reduced = information.collect();
  for (auto& [index, frame] : information.frames_) {
    frame.factor.compute(frame.rig_rig);
    information.eliminate(frame, reduced);
  }
  if (!information.factorise(reduced)) return std::nullopt;
  return information;
}

void PoseInformation::number_tags(const std::vector<int>& tags, int held_tag) {
  Eigen::Index next = 0;
  for (const int tag : tags) {
    if (tag != held_tag) offsets_[tag] = 6 * next++;
  }
}

std::optional<Eigen::Index> PoseInformation::offset_of(int tag) const {
  const auto found = offsets_.find(tag);
  return found == offsets_.end() ? std::nullopt : std::optional(found->second);
}

Eigen::MatrixXd PoseInformation::collect() {
  const auto size = 6 * static_cast<Eigen::Index>(offsets_.size());
  Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(size, size);
  gradient_ = Eigen::VectorXd::Zero(size);
  for (const LinearView& view : *views_) {
    Frame& frame = frames_[view.frame];
    frame.rig_rig += view.by_rig.transpose() * view.by_rig;
    frame.gradient += view.by_rig.transpose() * view.residual;
    Frame::OfTag& of_tag = frame.tags[view.tag];
    of_tag.rig_errors += view.by_rig.transpose() * view.by_error;
    of_tag.tag_rig += view.by_tag.transpose() * view.by_rig;
    const auto offset = offset_of(view.tag);
    if (!offset) continue;
    reduced.block<6, 6>(*offset, *offset) += view.by_tag.transpose() * view.by_tag;
    gradient_.segment<6>(*offset) += view.by_tag.transpose() * view.residual;
    add(by_errors_[view.tag], *offset, view.by_tag.transpose() * view.by_error);
  }
  return reduced;
}

void PoseInformation::eliminate(const Frame& frame, Eigen::MatrixXd& reduced) {
  std::vector<std::pair<Eigen::Index, Matrix6d>> eliminated;
  eliminated.reserve(frame.tags.size());
  for (const auto& [tag, of_tag] : frame.tags) {
    const auto offset = offset_of(tag);
    if (!offset) continue;
    eliminated.emplace_back(*offset, frame.factor.solve(of_tag.tag_rig.transpose()).transpose());
    gradient_.segment<6>(*offset) -= eliminated.back().second * frame.gradient;
  }
  for (const auto& [tag, of_tag] : frame.tags) {
    Blocks& by_errors = by_errors_[tag];
    const auto offset = offset_of(tag);
    for (const auto& [other, block] : eliminated) {
      add(by_errors, other, -block.lazyProduct(of_tag.rig_errors));
      if (offset && *offset <= other)  // the factor reads the lower triangle
        reduced.block<6, 6>(other, *offset) -= block.lazyProduct(of_tag.tag_rig.transpose());
    }
  }
}

bool PoseInformation::factorise(Eigen::MatrixXd& reduced) {
  // Metres and radians differ little in size here, but a far tag and a near one do: scale to a unit diagonal.
  scale_ = reduced.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  reduced.array().colwise() *= scale_.array();
  reduced.array().rowwise() *= scale_.transpose().array();
  factor_.compute(reduced);
  return factor_.info() == Eigen::Success && factor_.rcond() > 1e-14;
}

Eigen::MatrixXd PoseInformation::solve(Eigen::MatrixXd columns) const {
  columns.array().colwise() *= scale_.array();
  factor_.solveInPlace(columns);
  columns.array().colwise() *= scale_.array();
  return columns;
}

Eigen::MatrixXd PoseInformation::solve_sparse(const Eigen::MatrixXd& columns) const {
  if (inverse_.size() == 0) return solve(columns);
  std::vector<Eigen::Index> rows;
  for (Eigen::Index row = 0; row < columns.rows(); ++row)
    if (!columns.row(row).isZero(0.0)) rows.push_back(row);
  return inverse_(Eigen::all, rows) * columns(rows, Eigen::all);
}

Eigen::MatrixXd PoseInformation::poses_by_errors(int tag) const {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size(), 8);
  for (const auto& [offset, block] : by_errors_.at(tag)) columns.middleRows<6>(offset) = -block;
  return solve(std::move(columns));
}

PoseInformation::Matrix6x8d PoseInformation::frame_by_errors(int frame, int tag,
                                                             const Eigen::MatrixXd& poses) const {
  const Frame& of_frame = frames_.at(frame);
  Matrix6x8d right = Matrix6x8d::Zero();
  for (const auto& [other, of_tag] : of_frame.tags) {
    if (other == tag) right -= of_tag.rig_errors;
    if (const auto offset = offset_of(other))
      right -= of_tag.tag_rig.transpose() * poses.middleRows<6>(*offset);
  }
  return of_frame.factor.solve(right);
}

PoseInformation::FrameColumns PoseInformation::frames_by_parameter(
    const std::vector<ParameterView>& columns) const {
  FrameColumns by_frame;
  for (const ParameterView& column : columns) {
    const LinearView& view = (*views_)[column.view];
    const Eigen::MatrixXd own = view.by_rig.transpose() * column.by_parameter;
    const auto [at, is_new] = by_frame[view.frame].try_emplace(column.first, own);
    if (!is_new) at->second += own;
  }
  return by_frame;
}

ParameterInformation PoseInformation::eliminate_poses(const std::vector<ParameterView>& columns) const {
  Eigen::Index num = 0;
  for (const ParameterView& column : columns) num = std::max(num, column.first + column.by_parameter.cols());
  ParameterInformation result{Eigen::MatrixXd::Zero(num, num), Eigen::VectorXd::Zero(num), {}, {}};
  Eigen::MatrixXd coupling = Eigen::MatrixXd::Zero(size(), num);
  for (const auto& [index, by_parameter, first] : columns) {
    const LinearView& view = (*views_)[index];
    const Eigen::Index count = by_parameter.cols();
    result.information.block(first, first, count, count) += by_parameter.transpose() * by_parameter;
    result.gradient.segment(first, count) += by_parameter.transpose() * view.residual;
    if (const auto offset = offset_of(view.tag))
      coupling.block(*offset, first, 6, count) += view.by_tag.transpose() * by_parameter;
  }
  const FrameColumns by_frame = frames_by_parameter(columns);
  for (const auto& [index, of_frame] : by_frame) {
    const Frame& frame = frames_.at(index);
    for (const auto& [first, own] : of_frame) {
      const Eigen::Index count = own.cols();
      const Eigen::MatrixXd followed = frame.factor.solve(own);
      for (const auto& [other, of_other] : of_frame)
        result.information.block(other, first, of_other.cols(), count) -= of_other.transpose() * followed;
      result.gradient.segment(first, count) -= followed.transpose() * frame.gradient;
      for (const auto& [tag, of_tag] : frame.tags) {
        if (const auto offset = offset_of(tag))
          coupling.block(*offset, first, 6, count) -= of_tag.tag_rig * followed;
      }
    }
  }
  result.poses_by_parameter = -solve_sparse(coupling);
  result.information += coupling.transpose() * result.poses_by_parameter;
  result.gradient += result.poses_by_parameter.transpose() * gradient_;
  add_errors(columns, by_frame, result);
  return result;
}

void PoseInformation::add_errors(const std::vector<ParameterView>& columns, const FrameColumns& by_frame,
                                 ParameterInformation& result) const {
  const Eigen::Index num = result.gradient.size();
  const auto of = [&](int tag) -> Eigen::MatrixXd& {
    return result.gradient_by_errors.try_emplace(tag, Eigen::MatrixXd::Zero(num, 8)).first->second;
  };
  for (const auto& [index, by_parameter, first] : columns) {
    const LinearView& view = (*views_)[index];
    of(view.tag).middleRows(first, by_parameter.cols()) += by_parameter.transpose() * view.by_error;
  }
  for (const auto& [index, of_frame] : by_frame) {
    const Frame& frame = frames_.at(index);
    for (const auto& [first, own] : of_frame) {
      const Eigen::MatrixXd followed = frame.factor.solve(own);
      for (const auto& [tag, of_tag] : frame.tags)
        of(tag).middleRows(first, own.cols()) -= followed.transpose() * of_tag.rig_errors;
    }
  }
  for (const auto& [tag, blocks] : by_errors_) {
    Eigen::MatrixXd& of_tag = of(tag);
    for (const auto& [offset, block] : blocks)
      of_tag += result.poses_by_parameter.middleRows<6>(offset).transpose() * block;
  }
}

}  // namespace apriltrack
