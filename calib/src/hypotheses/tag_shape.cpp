// A print that is not the flat square of the stated size.

#include <cmath>

#include "faults/tag_fit.h"
#include "hypotheses/tag_hypotheses.h"

namespace apriltrack {
namespace {

// How large such errors are, as a share of the size (one standard deviation), and in how many tags.
constexpr double kSizeError = 0.05, kBendError = 0.03, kShareMisshapen = 0.03;

}  // namespace

Score score_of_shape(const TagViews& tag) {
  std::vector<ParameterView> columns;
  for (const std::size_t i : tag.views) {
    const TagView& view = tag.task.observations.views[tag.map.index[i]];
    columns.push_back(
        {i, tag.map.root_weights[i] * residual_by_shape(tag.task.observations, view, tag.map.state)});
  }
  return tag.score(columns);
}

std::vector<TagHypothesis> faults_of_shape(const TagViews& tag) {
  const Score score = score_of_shape(tag);
  const Eigen::Matrix3d all = Eigen::Matrix3d::Identity();
  const double log_prior = std::log(kShareMisshapen);
  return {{.kind = TagFinding::Kind::kSize,
           .evidence = evidence_of(score.combined(all.leftCols<1>()), tag.scale,
                                   Eigen::VectorXd::Constant(1, kSizeError), log_prior)},
          {.kind = TagFinding::Kind::kNotFlat,
           .evidence = evidence_of(score.combined(all.rightCols<2>()), tag.scale,
                                   Eigen::VectorXd::Constant(2, kBendError), log_prior)}};
}

}  // namespace apriltrack
