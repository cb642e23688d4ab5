#include "cameras/camera_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "numerics/normal_distribution.h"
#include "solve/bundle_adjustment.h"
#include "solve/camera_fit.h"

namespace apriltrack {
namespace {

constexpr int kFramesOfGroup = 5;  // neighbours repeat their errors: they are held out together
constexpr int kHeldOut = 4;        // every so many groups, one
constexpr int kLeastGroups = 3;    // of those held out
constexpr int kEnoughGroups = 10;  // where one fold has fewer, all are held out in turn
constexpr int kNoTag = -1;
constexpr double kClear = 2.0;              // standard deviations, of a normal distribution
constexpr double kMostOfView = 8.0 * 16.0;  // a view counts no more than at four sigmas

struct Split {
  std::vector<std::size_t> others, held_out;
  std::map<int, int> group_of_frame;
};

/// By the rank of their frames in time. fold: which of the groups are held out.
Split split(const Observations& observations, const std::vector<std::size_t>& views, int fold) {
  Split result;
  int rank = -1, last_frame = -1;
  for (const std::size_t v : views) {
    if (observations.views[v].frame != last_frame) ++rank;
    last_frame = observations.views[v].frame;
    const int group = result.group_of_frame[last_frame] = rank / kFramesOfGroup;
    const bool is_held_out = group % kHeldOut == fold;
    (is_held_out ? result.held_out : result.others).push_back(v);
  }
  return result;
}

/// Squared disagreement of each group of frames, their poses fitted to the map as it is; nullopt where these
/// do not settle.
std::optional<std::map<int, double>> disagreements(const PartTask& task,
                                                   const std::vector<std::size_t>& views, MapState state) {
  if (!settle_poses(task, {{}, views}, kNoTag, state, true)) return std::nullopt;
  std::map<int, double> of_frames;
  for (const std::size_t v : views) {
    bool is_valid = false;
    const Vector8d residual =
        whitened_residual(task.observations, task.observations.views[v], state, is_valid);
    of_frames[task.observations.views[v].frame] +=
        is_valid ? std::min(kMostOfView, residual.squaredNorm()) : kMostOfView;
  }
  return of_frames;
}

/// Squared disagreement of neighbouring frames that are held out together, appended to `sums`.
void add_groups(const std::map<int, double>& of_frames, const std::map<int, int>& group_of_frame,
                std::vector<double>& sums) {
  std::map<int, double> of_groups;
  for (const auto& [frame, squares] : of_frames) of_groups[group_of_frame.at(frame)] += squares;
  for (const auto& [group, squares] : of_groups) sums.push_back(squares);
}

/// Whether groups fall by more than chance: their logarithms, for one that is far off outweighs all others.
bool is_clearly_less(const std::vector<double>& before, const std::vector<double>& after) {
  constexpr double kLeast = 1e-9;
  const auto num = static_cast<double>(before.size());
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double gain = std::log((before[i] + kLeast) / (after[i] + kLeast));
    sum += gain;
    squares += gain * gain;
  }
  const double variance_of_mean = (squares - sum * sum / num) / (num * (num - 1.0));
  return sum / num > student_place(kClear, num - 1.0) * std::sqrt(std::max(0.0, variance_of_mean));
}

/// How much frames disagree that a map was not made from, by groups: with the cameras as they are, and with
/// cameras refined from the same frames as the map.
struct HeldOut {
  std::vector<double> before, after;
  std::size_t num_views = 0;

  double rms(const std::vector<double>& sums) const {
    return std::sqrt(std::reduce(sums.begin(), sums.end()) / (8.0 * static_cast<double>(num_views)));
  }
  bool is_clearly_better() const {
    return before.size() >= kLeastGroups && rms(after) < rms(before) && is_clearly_less(before, after);
  }
};

/// That the test was not passed.
std::string why_not(const HeldOut& held_out, double least_gain) {
  const double before = held_out.rms(held_out.before), after = held_out.rms(held_out.after);
  const std::string figures = fmt::format("({:.3f} sigmas before, {:.3f} after)", before, after);
  if (held_out.before.size() < kLeastGroups)
    return fmt::format(
        "too few frames to hold some out: of {} groups of {} neighbours there are {}; film more",
        kLeastGroups, kFramesOfGroup, held_out.before.size());
  if (after >= before) return "frames that were held out agree no better " + figures;
  if (!held_out.is_clearly_better())
    return "frames that were held out agree better by no more than chance " + figures;
  return fmt::format("frames that were held out agree better, but by less than {:.0f} % {}",
                     100.0 * least_gain, figures);
}

/// Why not, where it cannot be done.
std::optional<std::string> hold_out(const PartTask& task, const CameraParameters& parameters,
                                    const AdjustedPart& solved, const MapState& refined, int fold,
                                    const ParallelFor& parallel, HeldOut& result) {
  Split views = split(task.observations, solved.part.views, fold);
  const Part others = connected_to(task.observations, views.others, solved.held_tag, task.options.min_views);
  std::erase_if(views.held_out, [&](std::size_t v) {
    return !std::ranges::binary_search(others.tags, task.observations.views[v].tag);
  });
  if (others.tags.size() < 2 || views.held_out.empty()) return "too few frames to hold some out";
  std::optional<std::map<int, double>> squares_before, squares_after;
  std::array<bool, 2> are_settled{};
  parallel(2, [&](std::size_t i) {
    if (i == 0) {
      MapState state = solved.state;
      are_settled[i] = settle_poses(task, others, solved.held_tag, state, true);
      if (are_settled[i]) squares_before = disagreements(task, views.held_out, std::move(state));
    } else {
      CameraFit fit(task, parameters, others, solved.held_tag, refined);
      are_settled[i] = fit.run();
      if (are_settled[i]) squares_after = disagreements(task, views.held_out, fit.state());
    }
  });
  if (!are_settled[0]) return "the map without the held-out frames does not settle";
  if (!are_settled[1]) return "the views do not determine them";
  if (!squares_before || !squares_after) return "the held-out frames' poses do not settle";
  add_groups(*squares_before, views.group_of_frame, result.before);
  add_groups(*squares_after, views.group_of_frame, result.after);
  result.num_views += views.held_out.size();
  return std::nullopt;
}

}  // namespace

CameraTrial try_cameras(const PartTask& task, const CameraParameters& parameters, double least_gain,
                        const AdjustedPart& solved, const MapState& refined, const ParallelFor& parallel) {
  CameraTrial trial;
  HeldOut held_out;
  std::optional<std::string> failure;
  for (int fold = kHeldOut - 1; fold >= 0 && held_out.before.size() < kEnoughGroups; --fold)
    if (auto reason = hold_out(task, parameters, solved, refined, fold, parallel, held_out))
      failure = std::move(reason);
  if (held_out.num_views == 0) {
    trial.reason = *failure;
    return trial;
  }
  trial.held_out_before = held_out.rms(held_out.before);
  trial.held_out_after = held_out.rms(held_out.after);
  trial.is_passed =
      held_out.is_clearly_better() && trial.held_out_after <= (1.0 - least_gain) * trial.held_out_before;
  if (!trial.is_passed) trial.reason = why_not(held_out, least_gain);
  return trial;
}

}  // namespace apriltrack
