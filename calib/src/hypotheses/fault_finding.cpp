#include "hypotheses/fault_finding.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "faults/tag_places.h"

namespace apriltrack {
namespace {

using Kind = TagFinding::Kind;

constexpr std::size_t kLeastProbes = 4;
constexpr double kSameSize = 0.012, kClearlyOther = 4.5;  // share of the size, sigmas
constexpr double kToldOfBend = 2.0;                       // sigmas
constexpr double kClearlyOff = 20.0;                      // nats, of all views
constexpr double kNearlyAll = 0.9;                        // of what the best explains

bool is_shape(Kind kind) {
  return kind == Kind::kSize || kind == Kind::kNotFlat;
}

/// A fault, and which of the tag's views it has at a second place, if any.
struct FittedFault {
  Kind kind = Kind::kLoose;
  double cost = 0.0;
  ShapeError shape = {};
  TwoPlaces places = {};
  double left = 0.0;  ///< What it does not explain, and the best would not either.
};

/// Copies of one id may be of two sizes.
bool are_of_one_size(const TwoPlaces& two) {
  const auto sigma_of = [](const TagFit& fit) { return fit.shape.log_scale == 0.0 ? 0.0 : fit.scale_sigma; };
  const double sigma = std::hypot(sigma_of(two.fit), sigma_of(two.second));
  return std::abs(two.fit.shape.log_scale - two.second.shape.log_scale) <
         std::max(kSameSize, kClearlyOther * sigma);
}

/// Fewer unknowns first.
std::vector<FittedFault> fitted_faults(const std::vector<ProbeView>& probes, const TagFit& one) {
  std::vector<FittedFault> result;
  const double size_m = one.shape.size_m;
  for (const auto& [kind, freedom] :
       {std::pair(Kind::kSize, ShapeFreedom::kSize), std::pair(Kind::kNotFlat, ShapeFreedom::kBend)}) {
    const TagFit fit = fit_tag(probes, one, freedom);
    result.push_back({.kind = kind, .cost = fit.cost, .shape = shape_error_of(fit)});
  }
  if (const auto once = moved_once(probes, one, size_m))
    result.push_back({.kind = Kind::kMoved, .cost = once->cost, .places = *once});
  if (const auto turns = two_places(probes, one, size_m)) {
    const bool is_one_tag = is_one_change(turns->is_at_second) && are_of_one_size(*turns);
    const Kind kind = is_one_tag ? Kind::kMoved : Kind::kTwoPlaces;
    result.push_back({.kind = kind, .cost = turns->cost, .places = *turns});
  }
  return result;
}

/// The simplest that explains nearly as much as any of them. nullopt where none explains much; where views
/// are off that none explains, the tag has no place.
std::optional<FittedFault> best_fit(const std::vector<ProbeView>& probes, double size_m,
                                    const TagHypothesis* fault) {
  if (probes.size() < kLeastProbes) return std::nullopt;
  const TagFit one = fit_tag_anew(probes, size_m);
  const double unexplained = one.cost - usual_cost_of(probes);
  std::vector<FittedFault> fits = fitted_faults(probes, one);
  const double most = one.cost - std::ranges::min(fits, {}, &FittedFault::cost).cost;
  const double left = std::max(0.0, unexplained - most);
  if (fault && fault->kind == Kind::kLoose && most < kNearlyAll * unexplained) return FittedFault{};
  if (!fault && most < kNearlyAll * unexplained) return FittedFault{.left = left};
  if (most < kClearlyOff) return std::nullopt;
  FittedFault& simplest = *std::ranges::find_if(
      fits, [&](const FittedFault& fit) { return one.cost - fit.cost > kNearlyAll * most; });
  simplest.left = left;
  return std::move(simplest);
}

/// To first order.
FittedFault linear_fault(const RobustMap& scored, const TagHypothesis& fault, double size_m) {
  FittedFault result{.kind = fault.kind, .shape = {.size_m = size_m}};
  const Eigen::VectorXd& value = fault.evidence.value;
  const Eigen::VectorXd sigma = fault.evidence.covariance.diagonal().cwiseSqrt();
  if (fault.kind == Kind::kSize) {
    result.shape.log_scale = value[0];
    result.shape.scale_sigma = sigma[0];
  } else if (fault.kind == Kind::kNotFlat) {
    result.shape.aspect = value[0];
    result.shape.aspect_sigma = sigma[0];
    result.shape.twist = value[1];
    result.shape.twist_sigma = sigma[1];
  } else if (fault.kind != Kind::kLoose) {
    result.places.fit.T_map_tag = scored.state.T_map_tag[static_cast<std::size_t>(fault.tag)];
    result.places.second.T_map_tag = result.places.fit.T_map_tag * Pose::exp(Vector6d(value));
    result.places.is_at_second = fault.is_at_second;
  }
  return result;
}

void tell_what_is_clear(ShapeError& shape) {
  const double aspect = std::abs(shape.aspect) / shape.aspect_sigma,
               twist = std::abs(shape.twist) / shape.twist_sigma;
  shape.is_aspect_clear = aspect > kToldOfBend || aspect >= twist;
  shape.is_twist_clear = twist > kToldOfBend || twist > aspect;
}

/// views: of the tag, in the order of time.
void tell_places(const Observations& observations, const TwoPlaces& two,
                 const std::vector<std::size_t>& views, TagFinding& finding) {
  std::vector<Timestamp> times;
  for (const std::size_t v : views)
    times.push_back(observations.frames[static_cast<std::size_t>(observations.views[v].frame)]);
  finding.places = finding.kind == Kind::kMoved ? change_at_a_moment(two, times) : change_by_turns(two);
  for (std::size_t i = 0; i < views.size(); ++i)
    finding.views_by_place[two.is_at_second[i] ? 1 : 0].push_back(views[i]);
}

}  // namespace

FaultFound fault_of(const PartTask& task, const Part& part, const AdjustedPart& rest, int tag,
                    const RobustMap* scored, const TagHypothesis* fault) {
  const double size_m = task.observations.sizes_m[static_cast<std::size_t>(tag)];
  const std::vector<ProbeView> probes = probe_views(task, part, rest, tag);
  std::vector<std::size_t> views;
  for (const ProbeView& probe : probes)
    views.push_back(static_cast<std::size_t>(probe.view - task.observations.views.data()));
  std::optional<FittedFault> found = best_fit(probes, size_m, fault);
  const bool is_confirmed =
      found || !fault || fault->kind != Kind::kTwoPlaces || probes.size() < kLeastProbes;
  if (!found && fault) {
    found = linear_fault(*scored, *fault, size_m);
    views = fault->views;
  }
  if (!found) return {.finding = {.tag = tag, .kind = Kind::kLoose, .is_left_out = true}};
  TagFinding finding{.tag = tag, .kind = found->kind, .is_left_out = found->kind != Kind::kNotFlat};
  if (is_shape(finding.kind)) finding.shape = found->shape;
  if (finding.kind == Kind::kNotFlat) tell_what_is_clear(*finding.shape);
  if (finding.kind == Kind::kMoved || finding.kind == Kind::kTwoPlaces)
    tell_places(task.observations, found->places, views, finding);
  return {std::move(finding), is_confirmed, found->left};
}

}  // namespace apriltrack
