#include "tag_moves.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "corner_views.h"
#include "error_scale.h"
#include "pose_information.h"
#include "tag_fault_words.h"
#include "tag_places.h"

namespace apriltrack {
namespace {

constexpr std::size_t kManyTags = 200;  // the system is solved anew for each moment of each
constexpr std::size_t kLeastViews = 3;  // at each of the places
constexpr std::size_t kMostMoments = 24;
// Squares of six numbers, at the best of two dozen moments; of twelve, at the best two. What chance gives in
// the median, and what it hardly ever gives.
constexpr double kUsualOnce = 11.0, kUsualTwice = 20.0;
constexpr double kClearOnce = 60.0, kClearTwice = 100.0;
constexpr double kLeastInformed = 1e-4;  // of what the tag's own views say; less is what rounding leaves
constexpr std::size_t kLeastOthers = 3;
// What a second move explains further: beyond chance, and beyond what the first, linearised, leaves.
constexpr double kClearAgain = 35.0, kAgain = 0.1;

/// From some moments on a tag is elsewhere.
struct Move {
  int tag = 0;
  std::vector<std::size_t> views;         ///< Of the tag, into the views of the part; in the order of time.
  std::vector<std::size_t> moments = {};  ///< Into these: the first of each new place.
  Eigen::VectorXd changes = {};           ///< Right perturbations of the tag's pose, six for each moment.
  double squares = 0.0;                   ///< Of the changes, over their spread.

  Vector6d first_change() const { return changes.head<6>(); }
};

std::vector<std::size_t> views_of(const PartTask& task, const AdjustedPart& solved, int tag) {
  std::vector<std::size_t> views;
  for (std::size_t i = 0; i < solved.part.views.size(); ++i) {
    if (task.observations.views[solved.part.views[i]].tag == tag) views.push_back(i);
  }
  return views;
}

/// What all views say of the changes of the tag's pose at the move's moments.
void estimate(const std::vector<LinearView>& views, const PoseInformation& poses, const ErrorScale& scale,
              Move& move) {
  const auto num = 6 * static_cast<Eigen::Index>(move.moments.size());
  std::vector<ParameterView> columns;
  Eigen::VectorXd own = Eigen::VectorXd::Zero(num);
  for (std::size_t i = 0; i < move.views.size(); ++i) {
    const LinearView& view = views[move.views[i]];
    Eigen::MatrixXd by_changes = Eigen::MatrixXd::Zero(view.by_tag.rows(), num);
    for (std::size_t m = 0; m < move.moments.size(); ++m) {
      if (i >= move.moments[m]) by_changes.middleCols<6>(6 * static_cast<Eigen::Index>(m)) = view.by_tag;
    }
    own += by_changes.colwise().squaredNorm().transpose();
    columns.push_back({move.views[i], std::move(by_changes)});
  }
  const ParameterInformation of_changes = poses.eliminate_poses(columns);
  Eigen::MatrixXd information = of_changes.information;
  information.diagonal() += kLeastInformed * own;
  Eigen::MatrixXd spread = scale.noise_variance * information;
  for (const auto& [tag, gradient] : of_changes.gradient_by_errors)
    spread += scale.bias_variance * gradient * gradient.transpose();
  move.changes = -information.ldlt().solve(of_changes.gradient);
  move.squares = of_changes.gradient.dot(spread.ldlt().solve(of_changes.gradient));
}

/// With a further moment, the one that explains most; as it is where none explains more.
Move with_one_more_moment(const std::vector<LinearView>& views, const PoseInformation& poses,
                          const ErrorScale& scale, const Move& move) {
  Move best = move;
  if (move.views.size() < 2 * kLeastViews) return best;
  const std::size_t choices = move.views.size() - 2 * kLeastViews + 1;
  const std::size_t tried = std::min(choices, kMostMoments);
  for (std::size_t i = 0; i < tried; ++i) {
    Move trial = move;
    trial.moments.push_back(kLeastViews + i * choices / tried);
    estimate(views, poses, scale, trial);
    if (trial.changes.allFinite() && trial.squares > best.squares) best = std::move(trial);
  }
  return best;
}

/// The part's views, linearised with one noise for all frames: a tag that moves makes its frames seem noisy,
/// which would hide it.
struct LinearPart {
  std::vector<LinearView> views;
  std::optional<PoseInformation> poses;
  ErrorScale scale;

  LinearPart(const PartTask& task, const AdjustedPart& solved) {
    MapState state = solved.state;
    state.noise.of_frame.clear();
    views = corner_views(task.observations, solved.part.views, state);
    if (views.size() != solved.part.views.size()) return;
    poses = PoseInformation::of(views, solved.part.tags, solved.held_tag);
    if (!poses) return;
    const double bias = task.options.corner_bias_px / task.options.corner_sigma_px;
    scale = error_scale(views, *poses, bias * bias);
  }

  Move with_one_more(const Move& move) const { return with_one_more_moment(views, *poses, scale, move); }
};

/// Where the tag seems to have moved once, and where twice.
struct Suspicion {
  Move once, twice;
  double of_once = 0.0, of_twice = 0.0;  ///< Over 1: beyond chance, and beyond what the others show.

  double largest() const { return std::max(of_once, of_twice); }
};

/// How much more than by chance the others seem to move: neighbouring frames repeat their errors, and what a
/// lens does to all tags is no move.
double excess_of_others(const std::vector<Suspicion>& suspicions, const Suspicion& own,
                        Move Suspicion::*which, double usual) {
  std::vector<double> others;
  for (const Suspicion& one : suspicions) {
    if (&one != &own) others.push_back((one.*which).squares);
  }
  if (others.size() < kLeastOthers) return std::numeric_limits<double>::infinity();
  const auto middle = others.begin() + static_cast<std::ptrdiff_t>(others.size() / 2);
  std::ranges::nth_element(others, middle);
  return std::max(1.0, *middle / usual);
}

std::vector<Suspicion> suspicions_of(const PartTask& task, const AdjustedPart& solved,
                                     const LinearPart& part) {
  std::vector<Suspicion> result;
  for (const int tag : solved.part.tags) {
    Suspicion one;
    one.once = part.with_one_more({.tag = tag, .views = views_of(task, solved, tag)});
    one.twice = part.with_one_more(one.once);
    result.push_back(std::move(one));
  }
  for (Suspicion& one : result) {
    one.of_once =
        one.once.squares / (kClearOnce * excess_of_others(result, one, &Suspicion::once, kUsualOnce));
    one.of_twice =
        one.twice.squares / (kClearTwice * excess_of_others(result, one, &Suspicion::twice, kUsualTwice));
  }
  return result;
}

double size_m_of(const PartTask& task, int tag) {
  return task.observations.sizes_m[static_cast<std::size_t>(tag)];
}

TwoPlaces places_of(const Move& move, const AdjustedPart& solved) {
  TwoPlaces two{};
  two.fit.T_map_tag = solved.state.T_map_tag[static_cast<std::size_t>(move.tag)];
  two.second.T_map_tag = two.fit.T_map_tag * Pose::exp(move.first_change());
  for (std::size_t i = 0; i < move.views.size(); ++i) two.is_at_second.push_back(i >= move.moments.front());
  return two;
}

TagFinding to_finding(const PartTask& task, const AdjustedPart& solved, const Move& move, bool is_loose) {
  std::vector<ProbeView> when;
  for (const std::size_t i : move.views) {
    const TagView& view = task.observations.views[solved.part.views[i]];
    ProbeView probe;
    probe.view = &view;
    probe.timestamp = task.observations.frames[static_cast<std::size_t>(view.frame)];
    when.push_back(probe);
  }
  const std::string name = to_string(task.observations.tags[static_cast<std::size_t>(move.tag)]);
  TagFinding finding;
  finding.tag = move.tag;
  finding.is_left_out = true;
  finding.num_views = move.views.size();
  finding.kind = is_loose ? TagFinding::Kind::kLoose : TagFinding::Kind::kMoved;
  finding.words = is_loose
                      ? words_of_loose(name)
                      : words_of_move(places_of(move, solved), when, task.observations.frames.front(), name);
  return finding;
}

}  // namespace

std::optional<TagFinding> find_hidden_move(const PartTask& task, const AdjustedPart& solved) {
  if (solved.part.tags.size() > kManyTags) return std::nullopt;
  const LinearPart part(task, solved);
  if (!part.poses) return std::nullopt;
  const std::vector<Suspicion> suspicions = suspicions_of(task, solved, part);
  const Suspicion& most = *std::ranges::max_element(suspicions, {}, &Suspicion::largest);
  if (most.largest() < 1.0) return std::nullopt;
  // What moves again has no place.
  const Move& best = most.once;
  const bool is_loose =
      most.of_once < 1.0 || most.twice.squares - best.squares > std::max(kClearAgain, kAgain * best.squares);
  const double shift_m = best.first_change().head<3>().norm();
  if (!is_loose && shift_m < least_shift_m(Pose::exp(best.first_change()), size_m_of(task, best.tag)))
    return std::nullopt;
  return to_finding(task, solved, best, is_loose);
}

}  // namespace apriltrack
