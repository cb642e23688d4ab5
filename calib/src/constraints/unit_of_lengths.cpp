#include "constraints/unit_of_lengths.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "apriltrack/calib/map_constraints.h"

namespace apriltrack {
namespace {

constexpr double kOtherUnit = 10.0;     // of lengths, one over the other: no measurement errs so far
constexpr double kBeyondErrors = 5.0;   // sigmas
constexpr double kThatOfUnit = 1.2;     // a factor this near to a unit's says so
constexpr double kSomeLength_m = 1e-6;  // less is none

/// A length that constraints tell, and that the map has as well.
struct ToldLength {
  const MapConstraint* constraint;
  double measured_m, mapped_m;
  double sigma_m;  ///< Of what was measured and of the map: no less than the true one.

  double factor() const { return measured_m / mapped_m; }
  bool is_beyond_errors() const { return std::abs(measured_m - mapped_m) > kBeyondErrors * sigma_m; }
};

double sigma_of_tag_m(int tag, const ConstraintPrior& prior) {
  const auto offset = prior.offsets.find(tag);
  if (offset == prior.offsets.end()) return 0.0;
  return std::sqrt(prior.covariance.block<3, 3>(offset->second, offset->second).trace());
}

class ToldLengths {
 public:
  explicit ToldLengths(const ConstraintPrior& prior) : prior_(prior) {}

  void add(const BoundConstraint& bound) {
    const MapConstraint& constraint = *bound.constraint;
    if (const auto* distance = std::get_if<DistanceConstraint>(&constraint.what)) {
      add(constraint, distance->distance_m, distance->sigma_m, bound.tags[0], bound.tags[1]);
    } else if (const auto* pose = std::get_if<RelativePoseConstraint>(&constraint.what)) {
      add(constraint, pose->position_m.norm(), pose->sigma_m, bound.tags[0], bound.tags[1]);
    } else if (const auto* position = std::get_if<PositionConstraint>(&constraint.what)) {
      add_way_to(constraint, *position, bound.tags[0]);
    }
  }

  const std::vector<ToldLength>& all() const { return all_; }

 private:
  void add(const MapConstraint& constraint, double measured_m, double sigma_m, int a, int b) {
    const auto position = [&](int tag) {
      return prior_.T_held_tag[static_cast<std::size_t>(tag)].translation();
    };
    const double mapped_m = (position(a) - position(b)).norm();
    if (mapped_m < kSomeLength_m || measured_m < kSomeLength_m) return;
    all_.push_back(
        {&constraint, measured_m, mapped_m, sigma_m + sigma_of_tag_m(a, prior_) + sigma_of_tag_m(b, prior_)});
  }

  /// From the position before, as that is in a frame of its own; where all three coordinates are told.
  void add_way_to(const MapConstraint& constraint, const PositionConstraint& position, int tag) {
    const auto& p = position.position_m;
    if (!p[0] || !p[1] || !p[2]) return;
    if (last_ != nullptr) {
      const auto& q = last_->position_m;
      const Eigen::Vector3d way_m(*p[0] - *q[0], *p[1] - *q[1], *p[2] - *q[2]);
      add(constraint, way_m.norm(), position.sigma_m + last_->sigma_m, last_tag_, tag);
    }
    last_ = &position;
    last_tag_ = tag;
  }

  const ConstraintPrior& prior_;
  std::vector<ToldLength> all_;
  const PositionConstraint* last_ = nullptr;
  int last_tag_ = 0;
};

/// Where a metre is about `factor` of it; empty where that is of none.
std::string name_of_unit(double factor) {
  struct Unit {
    const char* name;
    double per_metre;
  };
  for (const Unit& unit : {Unit{"millimetres", 1000.0}, {"centimetres", 100.0}, {"inches", 39.37}}) {
    if (std::abs(std::log(factor / unit.per_metre)) < std::log(kThatOfUnit)) return unit.name;
  }
  return "";
}

/// example: one of those that are off.
std::string other_unit_in_words(const ToldLength& example, std::size_t num_off, std::size_t num_told) {
  const bool is_long = example.factor() > 1.0;
  const double times = is_long ? example.factor() : 1.0 / example.factor();
  const std::string comparison = is_long ? "long" : "short", unit = name_of_unit(times);
  const MapConstraint& constraint = *example.constraint;
  return fmt::format(
      "constraints tell lengths over {:g} times as {} as in the map ({} of {}), such as {}{}: {:.4g} m "
      "measured, {:.4g} m in the map, {:.0f} times as {}{}. Constraints and tag sizes are in metres: correct "
      "them; no map was made",
      kOtherUnit, comparison, num_off, num_told, constraint.where.empty() ? "" : constraint.where + ": ",
      title_of(constraint), example.measured_m, example.mapped_m, times, comparison,
      unit.empty() ? "" : fmt::format(" (are {} in {}?)", is_long ? "they" : "tag sizes", unit));
}

}  // namespace

std::optional<OtherUnit> find_other_unit(std::span<const BoundConstraint> constraints,
                                         const ConstraintPrior& prior) {
  ToldLengths lengths(prior);
  for (const BoundConstraint& bound : constraints) lengths.add(bound);
  for (const bool is_long : {true, false}) {
    std::vector<ToldLength> off;
    std::ranges::copy_if(lengths.all(), std::back_inserter(off), [&](const ToldLength& one) {
      return (is_long ? one.factor() : 1.0 / one.factor()) > kOtherUnit && one.is_beyond_errors();
    });
    if (off.empty() || 2 * off.size() <= lengths.all().size()) continue;
    const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    OtherUnit other{{}, ""};
    for (const ToldLength& one : off) other.constraints.push_back(one.constraint);
    std::ranges::nth_element(off, middle, {}, &ToldLength::factor);
    other.words = other_unit_in_words(*middle, off.size(), lengths.all().size());
    return other;
  }
  return std::nullopt;
}

}  // namespace apriltrack
