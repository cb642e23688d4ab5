// Which tags hang where: families, sizes, places that do not overlap.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "draw.h"
#include "places.h"

namespace apriltrack::worlds {
namespace {

using std::numbers::pi;

constexpr const char* kFamilies[] = {"tag36h11", "tag25h9", "tagStandard41h12", "tagCircle21h7", "tag16h5"};
constexpr double kMainFamily[] = {0.80, 0.07, 0.07, 0.06, 0.0};
// tag16h5 seldom: its codes are read into clutter, by any detector.
constexpr double kSecondFamily[] = {0.30, 0.25, 0.25, 0.15, 0.05};

struct TagStyle {
  int low_count, high_count;
  double low_size_m, high_size_m;
};

TagStyle style_of(WorldKind kind) {
  switch (kind) {
    case WorldKind::kRoom:
      return {6, 30, 0.08, 0.25};
    case WorldKind::kCorridor:
      return {8, 36, 0.10, 0.25};
    case WorldKind::kHall:
      return {12, 60, 0.15, 0.40};
    case WorldKind::kDesk:
      return {4, 24, 0.025, 0.09};
    default:
      return {5, 20, 0.03, 0.30};
  }
}

/// Half the diagonal of the print: beyond it another may begin.
double reach_m(const PlacedTag& tag, const TagPrint& print) {
  const TagFamily& family = TagFamily::get(tag.key.family);
  const double cell_m = tag.size_m / family.width_at_border();
  return std::numbers::sqrt2 * cell_m * (0.5 * family.total_width() + print.margin_cells);
}

/// Corners at the detected square's size, of a print as large as that of a tag36h11 of that size.
double size_for(const std::string& name, double size_m) {
  const TagFamily& family = TagFamily::get(name);
  return size_m * family.width_at_border() / (0.8 * family.total_width());
}

double turn_of(Draw& draw) {
  const double kind = draw.uniform(0.0, 1.0);
  if (kind < 0.6) return draw.uniform(-0.15, 0.15);
  if (kind < 0.8) return draw.integer(0, 3) * 0.5 * pi;
  return draw.uniform(-pi, pi);
}

class TagHanger {
 public:
  TagHanger(World& world, Draw& draw) : world_(world), draw_(draw) {
    for (const Surface& surface : world.surfaces) weights_.push_back(surface.weight);
    const int groups = draw.integer(2, 6);
    for (int i = 0; i < groups; ++i)
      groups_.push_back({draw.weighted(weights_), {draw.uniform(-0.8, 0.8), draw.uniform(-0.6, 0.6)}});
  }

  /// Whether a free place was found.
  bool hang(const TagKey& key, double size_m) {
    PlacedTag tag{.key = key, .size_m = size_m};
    const bool is_grouped = draw_.chance(0.6);
    const Group& group =
        groups_[static_cast<std::size_t>(draw_.integer(0, static_cast<int>(groups_.size()) - 1))];
    const Surface& surface = world_.surfaces[is_grouped ? group.surface : draw_.weighted(weights_)];
    const double reach = reach_m(tag, world_.print);
    const double turn_rad = turn_of(draw_);
    // Half the width of the print as it is turned: it must not stick out over the border.
    const double half_m = reach * std::cos(std::remainder(turn_rad - 0.25 * pi, 0.5 * pi));
    const Eigen::Vector2d room_for_it = surface.half_size_m.array() - half_m;
    if ((room_for_it.array() < 0.0).any()) return false;
    constexpr double kGroupSpread_m = 0.5;
    Eigen::Vector2d place(draw_.uniform(-1, 1) * room_for_it.x(), draw_.uniform(-1, 1) * room_for_it.y());
    if (is_grouped) {
      place = group.place.cwiseProduct(room_for_it) +
              kGroupSpread_m * Eigen::Vector2d(draw_.normal(), draw_.normal());
      place = place.cwiseMax(-room_for_it).cwiseMin(room_for_it);
    }
    const bool is_upright_wall =
        surface.body == kWalls && std::abs(surface.T_body_surface.rotation_matrix()(2, 2)) < 0.5;
    if (is_upright_wall)
      place.y() = std::clamp(place.y(), world_.room_size_m.z() / 2 - 2.3, world_.room_size_m.z() / 2 - 0.3);
    tag.body = surface.body;
    tag.surface = surface.name;
    tag.T_body_tag = surface.T_body_surface *
                     Pose(Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ())),
                          {place.x(), place.y(), 0.0});
    if (!is_free(tag, reach)) return false;
    world_.tags.push_back(tag);
    return true;
  }

 private:
  struct Group {
    std::size_t surface;
    Eigen::Vector2d place;  ///< In shares of the half size.
  };

  bool is_free(const PlacedTag& tag, double reach) const {
    const Pose T_world_tag = world_.T_world_tag(tag, 0.0);
    for (const PlacedTag& other : world_.tags) {
      const double apart = (T_world_tag.translation() - world_.T_world_tag(other, 0.0).translation()).norm();
      if (apart < reach + reach_m(other, world_.print)) return false;
    }
    if (tag.body != kWalls) return true;
    const double before_m = std::min(0.3, tag.size_m);  // furniture that stands there would hide it
    return !is_in_solid(world_, T_world_tag * Eigen::Vector3d(0.0, 0.0, -before_m), 0.5 * tag.size_m);
  }

  World& world_;
  Draw& draw_;
  std::vector<double> weights_;
  std::vector<Group> groups_;
};

}  // namespace

void draw_tags(World& world, std::uint64_t attempt) {
  Draw draw(world.seed, Part::kTags, attempt);
  const TagStyle style = style_of(world.kind);
  const int wanted = static_cast<int>(std::lround(draw.log_uniform(style.low_count, style.high_count)));
  world.print = {.margin_cells = draw.uniform(0.3, 1.5),
                 .ink = draw.uniform(0.025, 0.08),
                 .paper = draw.uniform(0.7, 0.85)};
  double largest_m = style.high_size_m;
  if (world.kind == WorldKind::kBody) largest_m = 1.1 * world.surfaces.back().half_size_m.minCoeff();
  std::vector<double> sizes;
  const int num_sizes = draw.integer(1, 4);
  for (int i = 0; i < num_sizes; ++i) {
    const double low = world.kind == WorldKind::kBody ? 0.35 * largest_m : style.low_size_m;
    sizes.push_back(std::round(1e3 * draw.log_uniform(low, largest_m)) /
                    1e3);  // whole millimetres, as people print
  }
  const std::string main = kFamilies[draw.weighted(kMainFamily)];
  const std::string second = kFamilies[draw.weighted(kSecondFamily)];
  const double share_of_second = draw.chance(0.3) && second != main ? draw.uniform(0.15, 0.5) : 0.0;

  TagHanger hanger(world, draw);
  std::set<TagKey> used;
  for (int tries = 0; tries < 60 * wanted && static_cast<int>(world.tags.size()) < wanted; ++tries) {
    const std::string& family = draw.chance(share_of_second) ? second : main;
    const TagKey key{family, draw.integer(0, TagFamily::get(family).num_codes() - 1)};
    const double size_m = size_for(family, sizes[static_cast<std::size_t>(draw.integer(0, num_sizes - 1))]);
    if (used.contains(key) || !hanger.hang(key, std::round(1e4 * size_m) / 1e4)) continue;
    used.insert(key);
  }
  world.drawn["tags"] = {{"wanted", wanted},
                         {"placed", world.tags.size()},
                         {"sizes_m", sizes},
                         {"main_family", main},
                         {"second_family", share_of_second > 0.0 ? second : ""},
                         {"margin_cells", world.print.margin_cells}};
}

}  // namespace apriltrack::worlds
