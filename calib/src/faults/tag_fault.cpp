#include "faults/tag_fault.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "faults/pliant_frames.h"
#include "faults/tag_fit.h"
#include "faults/tag_places.h"
#include "faults/view_spread.h"

namespace apriltrack {
namespace {

using Kind = TagFinding::Kind;

constexpr std::size_t kLeastProbes = 4;
constexpr double kClearOfKept = 4.5;   // of the errors that a tag keeps
constexpr double kTwistPerEdge = 2.0;  // a twist shows where the tag is seen from aside, and there by half
constexpr double kClearGainOfFault = 20.0;  // of half the sum of squares
constexpr double kClearShare = 0.25;        // of what is beyond the usual
constexpr double kMostLeft = 2.5;           // of the usual
constexpr double kNearlyAll = 0.8;  // of what is beyond the usual: a shape that explains it is no chance
// Misfit of one place, below which no second one is asked for.
constexpr double kMisfitOfTwo = 1.2;
constexpr double kMisfitOfMoved = 2.5;           // lens errors look like small moves
constexpr std::size_t kLeastViewsElsewhere = 3;  // views: however many the place explains
constexpr double kMisfitOfLoose = 2.0;           // something is always left
constexpr double kMostLeftOfPlaces = 0.3;        // of what is beyond the usual, or it may as well be loose

struct Hypothesis {
  Kind kind;
  double cost;  ///< With a fee for its unknowns.
  double fee;
  TagFit fit;
  std::optional<TwoPlaces> places;
  bool may_be_copies = false;
};

/// Copies of one id may be of two sizes.
bool are_of_one_tag(const TwoPlaces& two) {
  const auto sigma_of = [](const TagFit& fit) { return fit.shape.log_scale == 0.0 ? 0.0 : fit.scale_sigma; };
  const double sigma = std::hypot(sigma_of(two.fit), sigma_of(two.second));
  return is_one_change(two.is_at_second) && std::abs(two.fit.shape.log_scale - two.second.shape.log_scale) <
                                                std::max(kClearScale, kClearSigmas * sigma);
}

/// Beyond chance, and beyond what errors do that the tag keeps in all of its views, `kept`.
bool is_clear(double value, double sigma, double kept, double least, double misfit) {
  const double by_chance = kClearSigmas * sigma * std::sqrt(std::max(1.0, misfit));
  return std::abs(value) > std::max(least, std::hypot(by_chance, kClearOfKept * kept));
}

double mean_edge_of(const std::vector<ProbeView>& probes) {
  double sum = 0.0;
  for (const ProbeView& probe : probes) sum += mean_edge_px(probe.view->corners_px);
  return sum / static_cast<double>(probes.size());
}

/// Of a print of which one side alone is off, the one that explains more: as many unknowns as a size has.
TagFit fit_of_one_side(const std::vector<ProbeView>& probes, const TagFit& one) {
  TagFit width = fit_tag(probes, one, ShapeFreedom::kWidth);
  TagFit height = fit_tag(probes, one, ShapeFreedom::kHeight);
  TagFit& likelier = width.cost < height.cost ? width : height;
  likelier.is_aspect_clear = true;
  return likelier;
}

std::vector<Hypothesis> hypotheses_about(const std::vector<ProbeView>& probes, const TagFit& one,
                                         double misfit, double kept_px) {
  const double kept = kept_px / mean_edge_of(probes);  // as a share of the size
  const double size_m = one.shape.size_m;
  std::vector<Hypothesis> result;
  const TagFit scaled = fit_tag(probes, one, ShapeFreedom::kSize);
  if (is_clear(scaled.shape.log_scale, scaled.scale_sigma, kept, kClearScale, misfit)) {
    TagFit side = fit_of_one_side(probes, one);
    const bool is_one_side = side.cost < scaled.cost - kLikelierSide;
    result.push_back(is_one_side ? Hypothesis{Kind::kNotFlat, side.cost, 0.0, std::move(side), {}}
                                 : Hypothesis{Kind::kSize, scaled.cost, 0.0, scaled, {}});
  }
  TagFit bent = fit_tag(probes, one, ShapeFreedom::kBend);
  bent.is_aspect_clear = is_clear(bent.shape.aspect, bent.aspect_sigma, kept, kClearBend, misfit);
  bent.is_twist_clear =
      is_clear(bent.shape.twist, bent.twist_sigma, kTwistPerEdge * kept, kClearBend, misfit);
  if (bent.is_aspect_clear || bent.is_twist_clear)
    result.push_back({Kind::kNotFlat, bent.cost + 2.0 * kFeeOfUnknown, 2.0 * kFeeOfUnknown, bent, {}});
  const bool are_some_elsewhere = count_elsewhere(one, probes) >= kLeastViewsElsewhere;
  if (misfit < kMisfitOfTwo && !are_some_elsewhere) return result;
  if (misfit > kMisfitOfMoved || are_some_elsewhere) {
    auto moved = moved_once(probes, one, size_m);
    if (moved && (misfit > kMisfitOfMoved || is_beyond_doubt(*moved, probes))) {
      const double apart_m = moved->change().translation().norm();
      const bool may_be_copies = apart_m > least_between_tags_m(moved->change(), size_m);
      result.push_back({Kind::kMoved, moved->cost, moved->fee(), {}, moved, may_be_copies});
    }
  }
  if (auto places = two_places(probes, one, size_m)) {
    const Kind kind = are_of_one_tag(*places) ? Kind::kMoved : Kind::kTwoPlaces;
    result.push_back({kind, places->cost, places->fee(), {}, places, true});
  }
  return result;
}

std::vector<Timestamp> times_of(const std::vector<ProbeView>& probes) {
  std::vector<Timestamp> times;
  for (const ProbeView& probe : probes) times.push_back(probe.timestamp);
  return times;
}

/// What makes it this fault: its shape, or its places.
void describe(const Hypothesis& one, const std::vector<ProbeView>& probes, TagFinding& finding) {
  if (one.kind == Kind::kSize || one.kind == Kind::kNotFlat) finding.shape = shape_error_of(one.fit);
  if (one.kind == Kind::kMoved) finding.places = change_at_a_moment(*one.places, times_of(probes));
  if (one.kind == Kind::kTwoPlaces) finding.places = change_by_turns(*one.places);
}

std::array<std::vector<std::size_t>, 2> views_by_place(const Hypothesis& one,
                                                       const std::vector<ProbeView>& probes,
                                                       const Observations& observations) {
  std::array<std::vector<std::size_t>, 2> views;
  for (std::size_t i = 0; one.places && i < probes.size(); ++i) {
    const auto view = static_cast<std::size_t>(probes[i].view - observations.views.data());
    views[one.places->is_at_second[i] ? 1 : 0].push_back(view);
  }
  return views;
}

}  // namespace

TagLook look_at(const PartTask& task, const AdjustedPart& solved, const std::vector<ProbeView>& probes,
                int tag) {
  if (probes.size() < kLeastProbes) return {};
  const auto t = static_cast<std::size_t>(tag);
  const TagFit one = fit_tag_anew(probes, task.observations.sizes_m[t]);
  const double usual = usual_cost_of(probes);
  TagLook look{one.cost / usual, std::nullopt};
  const double mean_share = usual / (usual_probe_cost() * static_cast<double>(probes.size()));
  // A fee counts here for as much as a view does.
  const auto left_by = [&](const Hypothesis& it) { return it.cost - (1.0 - mean_share) * it.fee; };
  const auto num_views = static_cast<std::size_t>(std::ceil(usual / usual_probe_cost()));
  const auto hypotheses = hypotheses_about(probes, one, look.misfit, task.options.corner_bias_px);
  const auto best = std::ranges::min_element(hypotheses, {}, &Hypothesis::cost);
  const double least_gain = std::max(kClearGainOfFault, kClearShare * (one.cost - usual));
  const auto is_explanation = [&](const Hypothesis& it) {
    const bool is_shape = it.kind == Kind::kSize || it.kind == Kind::kNotFlat;
    return one.cost - it.cost > least_gain &&
           (left_by(it) < kMostLeft * usual ||
            (is_shape && one.cost - it.cost > kNearlyAll * (one.cost - usual)));
  };
  const bool is_explained = best != hypotheses.end() && is_explanation(*best);
  const bool leaves_much =
      is_explained && best->places && left_by(*best) - usual > kMostLeftOfPlaces * (one.cost - usual);
  const bool is_without_place =
      (!is_explained || leaves_much) && look.misfit > kMisfitOfLoose && is_loose(probes, one);
  if (is_explained && !is_without_place) {
    look.finding = {.tag = tag,
                    .kind = best->kind,
                    .may_be_copies = best->may_be_copies,
                    .is_left_out = best->kind != Kind::kNotFlat,
                    .misfit_before = look.misfit,
                    .misfit_after = left_by(*best) / usual,
                    .num_views = num_views,
                    .views_by_place = views_by_place(*best, probes, task.observations)};
    describe(*best, probes, *look.finding);
  } else if (is_without_place) {
    look.finding = {.tag = tag,
                    .kind = Kind::kLoose,
                    .is_left_out = true,
                    .misfit_before = look.misfit,
                    .misfit_after = kMisfitOfLoose,
                    .num_views = num_views};
    // It may have two places after all, and others may be at fault for it.
    if (is_explained) look.finding->views_by_place = views_by_place(*best, probes, task.observations);
  }
  if (look.finding && look.finding->kind == Kind::kNotFlat && is_seen_from_one_side(probes, one.T_map_tag))
    look.finding.reset();
  if (!look.finding) return look;
  const std::vector<ProbeView> witnesses = without_pliant_frames(task, solved, probes, one);
  return witnesses.size() < probes.size() ? look_at(task, solved, witnesses, tag) : look;
}

}  // namespace apriltrack
