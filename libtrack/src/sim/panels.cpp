#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "apriltrack/base/check.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/sim/scene.h"

namespace apriltrack {
namespace {

Panel tag_panel(const MapTag& tag, const TagPrint& print) {
  const TagFamily& family = TagFamily::get(tag.key.family);
  Panel panel;
  panel.T_body_panel = tag.T_map_tag;
  panel.cell_m = tag.size_m / family.width_at_border();
  panel.half_size_m.setConstant(panel.cell_m * (0.5 * family.total_width() + print.margin_cells));
  panel.reflectance = print.paper;
  panel.ink = print.ink;
  panel.tag = std::make_shared<const TagPattern>(family.pattern(tag.key.id));
  panel.is_decal = true;
  return panel;
}

Panel plain_panel(const Pose& T_body_panel, const Eigen::Vector2d& half_size_m, double reflectance) {
  Panel panel;
  panel.T_body_panel = T_body_panel;
  panel.half_size_m = half_size_m;
  panel.reflectance = reflectance;
  return panel;
}

}  // namespace

void add_tags(Body& body, const TagMap& map, const TagPrint& print) {
  APRILTRACK_CHECK(print.margin_cells >= 0.0, "margin_cells must be 0 or more");
  check_tag_map(map);
  for (const MapTag& tag : map.tags) body.panels.push_back(tag_panel(tag, print));
}

Eigen::Vector3d Bend::at(double u_m, double v_m) const {
  const double angle = curl_rad * u_m / width_m;
  const double half = 0.5 * angle;
  const double chord = std::abs(half) < 1e-9 ? u_m : u_m * std::sin(half) / half;
  const double twisted = twist_rad * u_m / width_m;
  const Eigen::Vector3d on_line(chord * std::cos(half), 0.0, -chord * std::sin(half));
  return on_line + rotation_exp({0.0, angle, 0.0}) *
                       (rotation_exp({twisted, 0.0, 0.0}) * Eigen::Vector3d(0.0, v_m, 0.0));
}

Bend add_bent_tag(Body& body, const MapTag& tag, Bend bend, const TagPrint& print) {
  constexpr int kStrips = 24;  // a curl of 60 degrees then lies within 0.02 % of its width from the strips
  const Panel flat = tag_panel(tag, print);
  bend.width_m = 2.0 * flat.half_size_m.x();
  const double step_m = bend.width_m / kStrips;
  for (int i = 0; i < kStrips; ++i) {
    const double u_m = (i + 0.5) * step_m - 0.5 * bend.width_m;
    const Eigen::Vector3d left = bend.at(u_m - 0.5 * step_m, 0.0);
    const Eigen::Vector3d right = bend.at(u_m + 0.5 * step_m, 0.0);
    const Eigen::Quaterniond R_tag_strip = rotation_exp({0.0, bend.curl_rad * u_m / bend.width_m, 0.0}) *
                                           rotation_exp({bend.twist_rad * u_m / bend.width_m, 0.0, 0.0});
    Panel strip = flat;
    strip.T_body_panel = tag.T_map_tag * Pose(R_tag_strip, 0.5 * (left + right));
    strip.half_size_m.x() = 0.5 * (right - left).norm();
    strip.tag_centre_m.x() = -u_m;
    strip.is_decal = false;  // strips share their borders, as the sides of a solid do
    body.panels.push_back(strip);
    const Pose half_turn(rotation_exp({0.0, std::numbers::pi, 0.0}), Eigen::Vector3d::Zero());
    body.panels.push_back(plain_panel(strip.T_body_panel * half_turn, strip.half_size_m, print.paper));
  }
  return bend;
}

void add_box(Body& body, const Pose& T_body_box, const Eigen::Vector3d& size_m, double reflectance) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const int right = (axis + 1) % 3;
      const int down = (axis + 2) % 3;
      Eigen::Matrix3d R_box_panel = Eigen::Matrix3d::Zero();  // z into the box
      R_box_panel(right, 0) = -side;
      R_box_panel(down, 1) = 1.0;
      R_box_panel(axis, 2) = -side;
      const Pose T_box_panel(R_box_panel,
                             Eigen::Vector3d(side * 0.5 * size_m[axis] * Eigen::Vector3d::Unit(axis)));
      body.panels.push_back(
          plain_panel(T_body_box * T_box_panel, {0.5 * size_m[right], 0.5 * size_m[down]}, reflectance));
    }
  }
}

void add_plate(Body& body, const Pose& T_body_plate, const Eigen::Vector2d& half_size_m, double reflectance,
               std::shared_ptr<const Texture> picture) {
  Panel front = plain_panel(T_body_plate, half_size_m, reflectance);
  front.picture = std::move(picture);
  body.panels.push_back(front);
  const Pose half_turn(rotation_exp(Eigen::Vector3d(0.0, M_PI, 0.0)), Eigen::Vector3d::Zero());
  body.panels.push_back(plain_panel(T_body_plate * half_turn, half_size_m, reflectance));
}

TagMap add_kalibr_grid(Body& body, const Pose& T_body_grid, int rows, int cols, double tag_size_m,
                       double spacing_ratio) {
  APRILTRACK_CHECK(rows > 0 && cols > 0, "a grid needs one row and one column or more");
  APRILTRACK_CHECK(tag_size_m > 0.0 && spacing_ratio > 0.0, "tag size and spacing must be > 0");
  const double gap = spacing_ratio * tag_size_m;
  const double pitch = tag_size_m + gap;
  const auto at = [&](double col, double row_from_bottom) {  // tag centres at whole numbers
    return T_body_grid *
           Pose(Eigen::Quaterniond::Identity(),
                {(col - 0.5 * (cols - 1)) * pitch, (0.5 * (rows - 1) - row_from_bottom) * pitch, 0.0});
  };
  add_plate(body, T_body_grid, {0.5 * (cols * pitch + 3 * gap), 0.5 * (rows * pitch + 3 * gap)},
            TagPrint{}.paper);

  TagMap map;
  map.frame = body.name.empty() ? "board" : body.name;
  map.default_family = "tag36h11b2";
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      MapTag tag;
      tag.key = {map.default_family, row * cols + col};
      tag.size_m = tag_size_m;
      tag.T_map_tag = at(col, row);
      map.tags.push_back(tag);
    }
  }
  TagPrint print;
  print.margin_cells = 0.0;
  add_tags(body, map, print);
  for (int row = 0; row <= rows; ++row) {
    for (int col = 0; col <= cols; ++col) {
      Panel square = plain_panel(at(col - 0.5, row - 0.5), {0.5 * gap, 0.5 * gap}, print.ink);
      square.is_decal = true;
      body.panels.push_back(square);
    }
  }
  return map;
}

}  // namespace apriltrack
