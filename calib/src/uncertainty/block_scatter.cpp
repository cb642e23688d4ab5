#include "uncertainty/block_scatter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace apriltrack {
namespace {

constexpr Eigen::Index kScatterBlocks = 8;        // long ones: what lasts a minute is seen
constexpr std::size_t kLeastFramesInBlocks = 40;  // fewer say nothing of blocks
constexpr std::size_t kMostBlocksUnseen = 3;      // a tag that few blocks show follows each of them
constexpr std::size_t kMostScatteringTags = 60;   // are asked how they scatter
// The factor 1 counts as this many numbers beside those of the blocks.
constexpr double kScatterPriorStrength = 4.0;
// The residuals of a block hide what the solution follows of its pull: a parameter by its own mean, which
// centred scores know; a tag by its pose as well.
constexpr double kSeen = static_cast<double>(kScatterBlocks - 1) / static_cast<double>(kScatterBlocks);

std::map<int, Eigen::Index> blocks_of_frames(const std::vector<LinearView>& views) {
  std::set<int> frames;
  for (const LinearView& view : views) frames.insert(view.frame);
  std::map<int, Eigen::Index> blocks;
  if (frames.size() < kLeastFramesInBlocks) return blocks;
  Eigen::Index rank = 0;
  for (const int frame : frames)
    blocks[frame] = rank++ * kScatterBlocks / static_cast<Eigen::Index>(frames.size());
  return blocks;
}

/// What a tag keeps in all of its views is counted elsewhere.
std::vector<LinearView::Residual> residuals_about_mean(const std::vector<LinearView>& views) {
  std::map<std::pair<int, int>, std::pair<LinearView::Residual, double>> sums;  // of a tag in a camera
  for (const LinearView& view : views) {
    auto& [sum, count] =
        sums.try_emplace({view.tag, view.camera}, LinearView::Residual::Zero(view.residual.size()), 0.0)
            .first->second;
    sum += view.residual;
    count += 1.0;
  }
  std::vector<LinearView::Residual> residuals;
  for (const LinearView& view : views) {
    const auto& [sum, count] = sums.at({view.tag, view.camera});
    residuals.emplace_back(view.residual - sum / count);
  }
  return residuals;
}

void fit_frames(const std::vector<LinearView>& views, std::vector<LinearView::Residual>& residuals) {
  std::map<int, std::pair<Matrix6d, Vector6d>> frames;  // normal equations
  for (std::size_t v = 0; v < views.size(); ++v) {
    auto& [H, g] = frames.try_emplace(views[v].frame, Matrix6d::Zero(), Vector6d::Zero()).first->second;
    H += views[v].by_rig.transpose() * views[v].by_rig;
    g += views[v].by_rig.transpose() * residuals[v];
  }
  for (auto& [frame, equations] : frames)
    equations.second = equations.first.ldlt().solve(equations.second).eval();
  for (std::size_t v = 0; v < views.size(); ++v)
    residuals[v] -= views[v].by_rig * frames.at(views[v].frame).second;
}

Eigen::MatrixXd about_mean(Eigen::MatrixXd columns) {
  columns.colwise() -= columns.rowwise().mean().eval();
  return columns;
}

/// seen: share of the squares that the fit leaves to be seen. squares: in units of what noise lets a number
/// scatter by, summed over blocks, and over `numbers`.
double factor(double squares, double numbers, double seen) {
  const double per_number = squares / (numbers * kSeen);  // about their mean over blocks
  const double count = numbers * static_cast<double>(kScatterBlocks - 1);
  return std::max(1.0, (kScatterPriorStrength + count * per_number / seen) / (kScatterPriorStrength + count));
}

}  // namespace

BlockScatter::BlockScatter(const std::vector<LinearView>& views, const PoseInformation& poses)
    : views_(views), poses_(poses) {
  const std::map<int, Eigen::Index> block_of_frame = blocks_of_frames(views);
  if (block_of_frame.empty()) return;
  for (const LinearView& view : views) block_of_view_.push_back(block_of_frame.at(view.frame));
  residuals_ = residuals_about_mean(views);
  fit_frames(views, residuals_);
}

Eigen::MatrixXd BlockScatter::scores(const PoseInformation& poses) const {
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(poses.size(), kScatterBlocks);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (const auto offset = poses.offset_of(views_[v].tag))
      scores.col(block_of_view_[v]).segment<6>(*offset) += views_[v].by_tag.transpose() * residuals_[v];
  }
  return scores;
}

double BlockScatter::tags_factor(double noise_variance) const {
  if (!has_blocks()) return 1.0;
  const SeenTags seen = seen_tags();
  if (seen.lasting.empty()) return 1.0;
  if (!poses_.offset_of(seen.most_seen)) return tags_factor_about(poses_, seen, noise_variance);
  const auto poses = PoseInformation::of(views_, seen.all, seen.most_seen);
  return poses ? tags_factor_about(*poses, seen, noise_variance) : 1.0;
}

BlockScatter::SeenTags BlockScatter::seen_tags() const {
  std::map<int, std::set<Eigen::Index>> blocks_of_tag;
  std::map<int, int> views_of_tag;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    blocks_of_tag[views_[v].tag].insert(block_of_view_[v]);
    ++views_of_tag[views_[v].tag];
  }
  SeenTags seen;
  seen.most_seen =
      std::ranges::max_element(views_of_tag, {}, [](const auto& tag) { return tag.second; })->first;
  for (const auto& [tag, blocks] : blocks_of_tag) {
    seen.all.push_back(tag);
    if (tag != seen.most_seen &&
        blocks.size() + kMostBlocksUnseen >= static_cast<std::size_t>(kScatterBlocks))
      seen.lasting.push_back(tag);
  }
  return seen;
}

double BlockScatter::tags_factor_about(const PoseInformation& poses, const SeenTags& seen,
                                       double noise_variance) const {
  const Eigen::MatrixXd pulled = about_mean(poses.solve(scores(poses)));
  const std::size_t step = (seen.lasting.size() + kMostScatteringTags - 1) / kMostScatteringTags;
  double squares = 0.0, numbers = 0.0;
  for (std::size_t i = 0; i < seen.lasting.size(); i += step) {
    const Eigen::Index offset = *poses.offset_of(seen.lasting[i]);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(poses.size(), 6);
    columns.middleRows<6>(offset).setIdentity();
    const Matrix6d expected = noise_variance * poses.solve(std::move(columns)).middleRows<6>(offset);
    const Eigen::MatrixXd own = pulled.middleRows<6>(offset);
    squares += own.cwiseProduct(expected.ldlt().solve(own)).sum();
    numbers += 6.0;
  }
  // Of tags that few blocks show nothing is known.
  const double known = static_cast<double>(seen.lasting.size()) / static_cast<double>(seen.all.size() - 1);
  return 1.0 + known * (factor(squares, numbers, kSeen * kSeen) - 1.0);
}

double BlockScatter::parameters_factor(const std::vector<ParameterView>& columns,
                                       const ParameterInformation& information, double noise_variance) const {
  if (!has_blocks()) return 1.0;
  Eigen::MatrixXd scores = information.poses_by_parameter.transpose() * this->scores(poses_);
  for (const ParameterView& column : columns)
    scores.col(block_of_view_[column.view]) += column.by_parameter.transpose() * residuals_[column.view];
  scores = about_mean(std::move(scores));
  // pull' covariance^-1 pull, of pull = C^-1 score and covariance = noise C^-1; what the prior says, whose
  // sigmas are the units, is no pull of theirs
  Eigen::MatrixXd with_prior = information.information;
  with_prior.diagonal().array() += noise_variance;
  const Eigen::LDLT<Eigen::MatrixXd> factor_of_both(with_prior);
  const Eigen::MatrixXd pulled = factor_of_both.solve(scores);
  // What the prior knows better is no number of theirs.
  const double numbers = factor_of_both.solve(information.information).trace();
  return factor(scores.cwiseProduct(pulled).sum() / noise_variance, numbers, kSeen);
}

}  // namespace apriltrack
