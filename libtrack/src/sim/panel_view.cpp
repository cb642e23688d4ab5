#include "panel_view.h"

#include <algorithm>
#include <cmath>

namespace apriltrack {
namespace {

constexpr double kNearPlane_m = 0.01;
constexpr float kEverywhere = 1e9F;
constexpr float kHorizon = 1e-4F;  // inverse depth below which a plane is not seen, 1/m

/// Length that [middle - width / 2, middle + width / 2] has in common with [-half, half].
float overlap(float middle, float width, float half) {
  const float low = std::max(middle - 0.5F * width, -half);
  const float high = std::min(middle + 0.5F * width, half);
  return std::max(high - low, 0.0F);
}

}  // namespace

/// What a pixel's area is in the panel's plane: a parallelogram, spanned by the columns (a, c) and (b, d).
struct PanelView::Footprint {
  float a, b, c, d;

  float reach_u() const { return 0.5F * (std::abs(a) + std::abs(b)); }
  float reach_v() const { return 0.5F * (std::abs(c) + std::abs(d)); }
};

std::optional<PanelView> PanelView::make(const PreparedPanel& prepared, const Pose& T_camera_panel,
                                         const Pose& T_world_panel, const Lighting& lighting) {
  const Pose T_panel_camera = T_camera_panel.inverse();
  const Eigen::Vector3d& eye = T_panel_camera.translation();
  if (eye.z() >= 0.0) return std::nullopt;  // z points into the surface: the eye is behind it
  const Panel& panel = *prepared.panel;
  const Eigen::Matrix3d R = T_panel_camera.rotation_matrix();

  PanelView view;
  view.prepared_ = &prepared;
  view.is_decal_ = panel.is_decal;
  // The ray from the eye meets z = 0 at depth -eye.z / (R ray).z.
  const Eigen::Vector3d inverse_depth = R.row(2).transpose() / -eye.z();
  const auto along = [&](int axis) -> Eigen::Vector3d {
    return (eye[axis] * inverse_depth + R.row(axis).transpose()) / prepared.unit_m;
  };
  view.u_ = RayForm(along(0));
  view.v_ = RayForm(along(1));
  view.inverse_depth_ = RayForm(inverse_depth);
  view.half_u_ = static_cast<float>(panel.half_size_m.x() / prepared.unit_m);
  view.half_v_ = static_cast<float>(panel.half_size_m.y() / prepared.unit_m);
  view.set_bounds(T_camera_panel);
  if (view.bounds_.min_x > view.bounds_.max_x) return std::nullopt;
  view.tag_u_ = static_cast<float>(panel.tag_centre_m.x() / prepared.unit_m);
  view.tag_v_ = static_cast<float>(panel.tag_centre_m.y() / prepared.unit_m);
  view.set_shading(T_world_panel, lighting);
  if (panel.gloss > 0.0) view.set_gloss(T_panel_camera, T_world_panel, lighting);
  return view;
}

/// Bounds of the part before the near plane (its outline clipped edge by edge); empty when all lies behind.
void PanelView::set_bounds(const Pose& T_camera_panel) {
  const Eigen::Vector2d& half = prepared_->panel->half_size_m;
  bounds_ = {kEverywhere, -kEverywhere, kEverywhere, -kEverywhere};
  const auto include = [&](const Eigen::Vector3d& point) {
    const auto ray_x = static_cast<float>(point.x() / point.z());
    const auto ray_y = static_cast<float>(point.y() / point.z());
    bounds_.min_x = std::min(bounds_.min_x, ray_x);
    bounds_.max_x = std::max(bounds_.max_x, ray_x);
    bounds_.min_y = std::min(bounds_.min_y, ray_y);
    bounds_.max_y = std::max(bounds_.max_y, ray_y);
  };
  const auto corner = [&](int i) -> Eigen::Vector3d {
    const double x = i == 0 || i == 3 ? -half.x() : half.x();
    const double y = i < 2 ? -half.y() : half.y();
    return T_camera_panel * Eigen::Vector3d(x, y, 0.0);
  };
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d from = corner(i);
    const Eigen::Vector3d to = corner((i + 1) % 4);
    if (from.z() >= kNearPlane_m) include(from);
    if ((from.z() >= kNearPlane_m) != (to.z() >= kNearPlane_m)) {
      include(from + (kNearPlane_m - from.z()) / (to.z() - from.z()) * (to - from));
    }
  }
}

void PanelView::set_shading(const Pose& T_world_panel, const Lighting& lighting) {
  const Eigen::Vector2d& half = prepared_->panel->half_size_m;
  const Eigen::Vector3d outward = -(T_world_panel.rotation() * Eigen::Vector3d::UnitZ());
  const auto light = [&](double x, double y) {
    return static_cast<float>(lighting.irradiance(T_world_panel * Eigen::Vector3d(x, y, 0.0), outward));
  };
  shade_ = light(0.0, 0.0);
  shade_per_u_ = (light(half.x(), 0.0) - light(-half.x(), 0.0)) / (2.0F * half_u_);
  shade_per_v_ = (light(0.0, half.y()) - light(0.0, -half.y())) / (2.0F * half_v_);
}

void PanelView::set_gloss(const Pose& T_panel_camera, const Pose& T_world_panel, const Lighting& lighting) {
  const double unit_m = prepared_->unit_m;
  const Eigen::Vector3d lamp = T_world_panel.inverse() * lighting.lamp_world / unit_m;
  if (lamp.z() >= 0.0) return;  // shines on the back
  const Panel& panel = *prepared_->panel;
  gloss_ = static_cast<float>(panel.gloss);
  gloss_sharpness_ = static_cast<float>(1.0 / (panel.gloss_width_rad * panel.gloss_width_rad));
  lamp_ = lamp.cast<float>();
  const Eigen::Vector3d eye = T_panel_camera.translation() / unit_m;
  mirrored_eye_ = Eigen::Vector3d(eye.x(), eye.y(), -eye.z()).cast<float>();
}

/// A Gaussian lobe about the mirrored ray, exp(-(1 - cos a) / width^2); it changes little within a pixel, so
/// that its middle stands for it.
float PanelView::highlight(float u, float v) const {
  const Eigen::Vector3f point(u, v, 0.0F);
  const Eigen::Vector3f mirrored_ray = point - mirrored_eye_;
  const Eigen::Vector3f to_lamp = lamp_ - point;
  const float cosine =
      mirrored_ray.dot(to_lamp) / std::sqrt(mirrored_ray.squaredNorm() * to_lamp.squaredNorm());
  return gloss_ * std::exp(gloss_sharpness_ * (cosine - 1.0F));
}

float PanelView::picture_at(const Texture& picture, float u, float v, float unit_per_px) const {
  const int wanted = static_cast<int>(std::lround(std::log2(std::max(unit_per_px, 1.0F))));
  const int index = std::min(wanted, picture.num_levels() - 1);
  const Image<float>& level = picture.level(index);
  const float scale = std::ldexp(1.0F, -index);
  const float x = std::clamp((u + half_u_) * scale - 0.5F, 0.0F, static_cast<float>(level.width()) - 1.001F);
  const float y = std::clamp((v + half_v_) * scale - 0.5F, 0.0F, static_cast<float>(level.height()) - 1.001F);
  const int ix = static_cast<int>(x);
  const int iy = static_cast<int>(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const float top = level(ix, iy) + fx * (level(ix + 1, iy) - level(ix, iy));
  const float bottom = level(ix, iy + 1) + fx * (level(ix + 1, iy + 1) - level(ix, iy + 1));
  return top + fy * (bottom - top);
}

/// Of a panel without a tag, where it covers the whole area.
PanelView::Shown PanelView::show_paint(float u, float v, float unit_per_px) const {
  const Panel& panel = *prepared_->panel;
  const float reflectance =
      panel.picture ? picture_at(*panel.picture, u, v, unit_per_px) : static_cast<float>(panel.reflectance);
  const float opacity = panel.opacity ? picture_at(*panel.opacity, u, v, unit_per_px) : 1.0F;
  return {reflectance * opacity, opacity};
}

/// A part of a pixel as an upright box of the panel's plane, with the part's variance along each axis: what
/// an edge along u or v makes of it is then right in place, and nearly so in shape.
PanelView::Shown PanelView::show_part(float u, float v, float width_u, float width_v) const {
  const float area = width_u * width_v;
  const float coverage = overlap(u, width_u, half_u_) * overlap(v, width_v, half_v_) / area;
  if (coverage <= 0.0F) return {};
  const Panel& panel = *prepared_->panel;
  const auto white = static_cast<float>(panel.reflectance);
  if (prepared_->cells) {
    const float tag_u = u - tag_u_;
    const float tag_v = v - tag_v_;
    const float ink = prepared_->cells->ink_in_box(tag_u - 0.5F * width_u, tag_u + 0.5F * width_u,
                                                   tag_v - 0.5F * width_v, tag_v + 0.5F * width_v) /
                      area;
    return {white * coverage - (white - static_cast<float>(panel.ink)) * ink, coverage};
  }
  const Shown paint = show_paint(u, v, std::sqrt(area));
  return {paint.colour * coverage, paint.coverage * coverage};
}

PanelView::Shown PanelView::show(float u, float v, const Footprint& area, int splits) const {
  const float reach_u = area.reach_u();
  const float reach_v = area.reach_v();
  const Panel& panel = *prepared_->panel;
  if (std::abs(u) + reach_u <= half_u_ && std::abs(v) + reach_v <= half_v_) {
    if (!prepared_->cells) {
      return show_paint(u, v, std::sqrt(std::abs(area.a * area.d - area.b * area.c)));
    }
    const float tag_u = u - tag_u_;
    const float tag_v = v - tag_v_;
    const float ink =
        prepared_->cells->uniform_ink(tag_u - reach_u, tag_u + reach_u, tag_v - reach_v, tag_v + reach_v);
    if (ink >= 0.0F)
      return {static_cast<float>(panel.reflectance + ink * (panel.ink - panel.reflectance)), 1.0F};
  }
  const float part = 1.0F / static_cast<float>(splits);
  const float width_u = part * std::sqrt(area.a * area.a + area.b * area.b);
  const float width_v = part * std::sqrt(area.c * area.c + area.d * area.d);
  Shown sum;
  for (int j = 0; j < splits; ++j) {
    const float y = (static_cast<float>(j) + 0.5F) * part - 0.5F;
    for (int i = 0; i < splits; ++i) {
      const float x = (static_cast<float>(i) + 0.5F) * part - 0.5F;
      const Shown shown =
          show_part(u + area.a * x + area.b * y, v + area.c * x + area.d * y, width_u, width_v);
      sum.colour += shown.colour;
      sum.coverage += shown.coverage;
    }
  }
  return {sum.colour * part * part, sum.coverage * part * part};
}

/// The areas of a row of pixels in the panel's plane, and which of them the panel may touch. Plain loops
/// without branches, which the compiler turns into wide instructions: most pixels of a tile end here.
struct PanelView::RowOfAreas {
  float u[kTileWidth];
  float v[kTileWidth];
  float a[kTileWidth];
  float b[kTileWidth];
  float c[kTileWidth];
  float d[kTileWidth];
  int is_touched[kTileWidth];
};

bool PanelView::trace_row(const Tile& tile, const float* ray_x, const float* ray_y, RowOfAreas& row) const {
  const float x_0 = tile.ray_per_px(0, 0), x_1 = tile.ray_per_px(0, 1);
  const float y_0 = tile.ray_per_px(1, 0), y_1 = tile.ray_per_px(1, 1);
  // Copies, so that no store into the row can change what the loop reads: else it stays narrow.
  const RayForm u_form = u_;
  const RayForm v_form = v_;
  const RayForm depth_form = inverse_depth_;
  const float half_u = half_u_;
  const float half_v = half_v_;
  const int width = tile.width;
  int num_touched = 0;
  for (int i = 0; i < width; ++i) {
    const float inverse_depth = depth_form.at(ray_x[i], ray_y[i]);
    const bool is_ahead = inverse_depth > kHorizon;
    const float depth = 1.0F / (is_ahead ? inverse_depth : 1.0F);
    const float u = u_form.at(ray_x[i], ray_y[i]) * depth;
    const float v = v_form.at(ray_x[i], ray_y[i]) * depth;
    const float u_x = (u_form.x - u * depth_form.x) * depth;
    const float u_y = (u_form.y - u * depth_form.y) * depth;
    const float v_x = (v_form.x - v * depth_form.x) * depth;
    const float v_y = (v_form.y - v * depth_form.y) * depth;
    const Footprint area{u_x * x_0 + u_y * y_0, u_x * x_1 + u_y * y_1, v_x * x_0 + v_y * y_0,
                         v_x * x_1 + v_y * y_1};
    row.u[i] = u;
    row.v[i] = v;
    row.a[i] = area.a;
    row.b[i] = area.b;
    row.c[i] = area.c;
    row.d[i] = area.d;
    const int is_near_u = std::abs(u) - area.reach_u() < half_u ? 1 : 0;
    const int is_near_v = std::abs(v) - area.reach_v() < half_v ? 1 : 0;
    row.is_touched[i] = is_ahead & is_near_u & is_near_v;
    num_touched += row.is_touched[i];
  }
  return num_touched > 0;
}

void PanelView::draw(const TileLook& look, int splits, BodyLayer& layer) const {
  const Tile& tile = look.tile;
  RowOfAreas row;
  for (int y = 0; y < tile.height; ++y) {
    if (!trace_row(tile, look.ray_x(y), look.ray_y(y), row)) continue;
    for (int x = 0; x < tile.width; ++x) {
      if (row.is_touched[x] == 0) continue;
      const Shown shown = show(row.u[x], row.v[x], {row.a[x], row.b[x], row.c[x], row.d[x]}, splits);
      const float shade = shade_ + shade_per_u_ * row.u[x] + shade_per_v_ * row.v[x];
      const float mirrored = gloss_ > 0.0F ? highlight(row.u[x], row.v[x]) : 0.0F;
      put(shade * shown.colour + mirrored * shown.coverage, shown.coverage, layer.colour[y * kTileWidth + x],
          layer.coverage[y * kTileWidth + x]);
    }
  }
}

void PanelView::put(float colour, float coverage, float& layer_colour, float& layer_coverage) const {
  if (is_decal_) {
    layer_colour += colour - coverage * layer_colour;
    layer_coverage += coverage * (1.0F - layer_coverage);
  } else {  // sides of a solid share their edges, so that their areas add up
    layer_colour += colour;
    layer_coverage += coverage;
  }
}

}  // namespace apriltrack
