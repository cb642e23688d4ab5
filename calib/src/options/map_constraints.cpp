#include "apriltrack/calib/map_constraints.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "apriltrack/base/error.h"
#include "apriltrack/tags/tag_family.h"
#include "numerics/words.h"

namespace apriltrack {
namespace {

constexpr double kLeastSigma = 1e-6, kMostSigma_m = 1000.0, kMostSigma_rad = 3.2;
constexpr double kMostCoordinate_m = 1e7;  // as in a map
constexpr double kMaxNormError = 1e-3;     // of a quaternion, as in a map

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;  // Clang before 17 does not deduce it for aggregates.

/// "3", or "tag36h11/3" where the family is told.
std::string short_name(const TagKey& key) {
  return key.family.empty() ? std::to_string(key.id) : to_string(key);
}

/// Complains of one constraint.
class ConstraintCheck {
 public:
  explicit ConstraintCheck(const MapConstraint& constraint) : constraint_(constraint) {}

  void operator()(const PositionConstraint& c) const {
    require(std::ranges::any_of(c.position_m, [](const auto& one) { return one.has_value(); }), "position_m",
            "empty", "one coordinate or more of x, y and z");
    for (const auto& one : c.position_m) {
      if (one) coordinate(*one, "position_m");
    }
    sigma_m(c.sigma_m);
  }
  void operator()(const DistanceConstraint& c) const {
    require(c.distance_m > 0.0 && c.distance_m <= kMostCoordinate_m, "distance_m",
            fmt::format("{}", c.distance_m), "in (0, 1e7] m");
    sigma_m(c.sigma_m);
  }
  void operator()(const RelativePoseConstraint& c) const {
    for (const double one : c.position_m) coordinate(one, "position_m");
    sigma_m(c.sigma_m);
    require(c.orientation.has_value() == c.sigma_rad.has_value(), "sigma_rad",
            c.sigma_rad ? "given" : "missing", "given where 'orientation' is, and only there");
    if (c.orientation)
      require(std::abs(c.orientation->norm() - 1.0) <= kMaxNormError, "orientation",
              fmt::format("of length {:.6g}", c.orientation->norm()), "a quaternion of length 1");
    sigma_rad(c.sigma_rad);
  }
  void operator()(const CoplanarConstraint& c) const {
    const std::size_t least = c.sigma_rad ? 2 : 4;
    require(c.tags.size() >= least, "tags", counted(c.tags.size(), "tag"),
            c.sigma_rad ? "two tags or more" : "four tags or more (two, with sigma_rad)");
    sigma_m(c.sigma_m);
    sigma_rad(c.sigma_rad);
  }
  void operator()(const UprightConstraint& c) const { sigma_rad(c.sigma_rad); }
  void operator()(const FloorConstraint& c) const {
    sigma_m(c.sigma_m);
    sigma_rad(c.sigma_rad);
  }
  void operator()(const GravityConstraint& c) const {
    direction(c.direction_tag);
    sigma_rad(c.sigma_rad);
  }
  void operator()(const CameraGravityConstraint& c) const {
    direction(c.direction_camera);
    sigma_rad(c.sigma_rad);
  }

  void tags() const {
    std::vector<TagKey> keys = tags_of(constraint_);
    for (const TagKey& key : keys) tag(key);
    std::ranges::sort(keys);
    const auto twice = std::ranges::adjacent_find(keys);
    require(twice == keys.end(), "tags", twice == keys.end() ? "" : short_name(*twice) + " twice",
            "different tags");
  }

 private:
  void require(bool is_right, std::string_view key, const std::string& value, std::string_view range) const {
    if (is_right) return;
    const std::string title = title_of(constraint_);
    throw invalid_input(constraint_.where.empty() ? "constraint" : constraint_.where,
                        fmt::format("{}: {}: must be {} (is {})", title, key, range, value));
  }
  /// Of any length: m/s^2, counts of a sensor, or 1.
  void direction(const Eigen::Vector3d& value) const {
    require(value.allFinite() && value.cwiseAbs().maxCoeff() > 0.0, "direction",
            fmt::format("{}", fmt::join(value, ", ")), "finite, and not zero");
  }
  void coordinate(double value_m, std::string_view key) const {
    require(std::abs(value_m) <= kMostCoordinate_m, key, fmt::format("{}", value_m), "within 1e7 m");
  }
  void sigma_m(double value) const {
    require(value >= kLeastSigma && value <= kMostSigma_m, "sigma_m", fmt::format("{}", value),
            "in [1e-6, 1000] m");
  }
  void sigma_rad(std::optional<double> value) const {
    if (value)
      require(*value >= kLeastSigma && *value <= kMostSigma_rad, "sigma_rad", fmt::format("{}", *value),
              "in [1e-6, 3.2] rad");
  }
  void tag(const TagKey& key) const {
    if (key.family.empty()) return require(key.id >= 0, "tags", std::to_string(key.id), "ids of 0 or more");
    require(TagFamily::is_known(key.family), "tags", fmt::format("'{}'", key.family),
            fmt::format("of one of the families {}", fmt::join(TagFamily::names(), ", ")));
  }

  const MapConstraint& constraint_;
};

}  // namespace

bool is_of_frame(const MapConstraint& constraint) {
  return !std::holds_alternative<DistanceConstraint>(constraint.what) &&
         !std::holds_alternative<RelativePoseConstraint>(constraint.what) &&
         !std::holds_alternative<CoplanarConstraint>(constraint.what);
}

std::string type_of(const MapConstraint& constraint) {
  return std::visit(Overloaded{[](const PositionConstraint&) { return "position"; },
                               [](const DistanceConstraint&) { return "distance"; },
                               [](const RelativePoseConstraint&) { return "relative_pose"; },
                               [](const CoplanarConstraint&) { return "coplanar"; },
                               [](const UprightConstraint&) { return "upright"; },
                               [](const FloorConstraint&) { return "floor"; },
                               [](const GravityConstraint&) { return "gravity"; },
                               [](const CameraGravityConstraint&) { return "gravity"; }},
                    constraint.what);
}

std::vector<TagKey> tags_of(const MapConstraint& constraint) {
  return std::visit(Overloaded{[](const DistanceConstraint& c) {
                                 return std::vector<TagKey>{c.a, c.b};
                               },
                               [](const RelativePoseConstraint& c) {
                                 return std::vector<TagKey>{c.a, c.b};
                               },
                               [](const CoplanarConstraint& c) { return c.tags; },
                               [](const CameraGravityConstraint&) { return std::vector<TagKey>{}; },
                               [](const auto& c) { return std::vector<TagKey>{c.tag}; }},
                    constraint.what);
}

std::string title_of(const MapConstraint& constraint) {
  if (!constraint.name.empty()) return constraint.name;
  if (const auto* gravity = std::get_if<CameraGravityConstraint>(&constraint.what))
    return fmt::format("gravity {} at {}", gravity->camera, gravity->timestamp.ns);
  std::vector<std::string> names;
  for (const TagKey& key : tags_of(constraint)) names.push_back(short_name(key));
  return fmt::format("{} {}", type_of(constraint), fmt::join(names, "-"));
}

void check_constraint(const MapConstraint& constraint) {
  const ConstraintCheck check(constraint);
  check.tags();
  std::visit(check, constraint.what);
}

ConstraintError::ConstraintError(std::string_view what, std::vector<ConstraintAudit> audits)
    : Error(ErrorKind::kNoResult, "calibrate", what), audits_(std::move(audits)) {}

std::pair<std::string, std::string> told_apart(double a, double b, int least) {
  constexpr int kMost = 12;
  std::string text_a, text_b;
  for (int decimals = least; decimals <= kMost; ++decimals) {
    text_a = fmt::format("{:.{}f}", a, decimals);
    text_b = fmt::format("{:.{}f}", b, decimals);
    if (text_a != text_b || a == b) break;
  }
  return {text_a, text_b};
}

double ConstraintReading::sigmas_off() const {
  return sigma ? std::abs(*predicted - measured) / *sigma : -1.0;
}

}  // namespace apriltrack
