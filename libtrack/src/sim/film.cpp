#include "film.h"

#include <algorithm>
#include <cmath>

#include "drawing_order.h"

namespace apriltrack {
namespace {

/// Points per pixel, over all pictures of which the film is the sum, where walls meet; and parts per pixel
/// across edges of panels: few pictures leave the whole of a pixel's area to each, many share the work.
constexpr int kEdgeSamples = 32;
int samples_per_picture(int num_pictures) {
  return std::max(1, kEdgeSamples / num_pictures);
}
int splits_per_picture(int num_pictures) {
  return num_pictures <= 16 ? 4 : 2;
}

struct BodyInstant {
  std::vector<PanelView> panels;
  RayBounds bounds{1e9F, -1e9F, 1e9F, -1e9F};
  bool is_fixed = false;  ///< Before a fixed camera.
};

struct InstantView {
  int index = 0;
  float light = 0.0F;
  RoomView room;
  std::vector<BodyInstant> bodies;  ///< Far to near.
};

void include(RayBounds& all, const RayBounds& one) {
  all.min_x = std::min(all.min_x, one.min_x);
  all.max_x = std::max(all.max_x, one.max_x);
  all.min_y = std::min(all.min_y, one.min_y);
  all.max_y = std::max(all.max_y, one.max_y);
}

BodyInstant view_body(const PreparedScene& prepared, const PreparedScene::PreparedBody& body,
                      const Pose& T_camera_world, double time_s) {
  BodyInstant view;
  view.is_fixed = body.is_fixed;
  const Pose T_world_body = prepared.scene->T_world_body(*body.body, time_s);
  for (const PreparedPanel& panel : body.panels) {
    const Pose T_world_panel = T_world_body * panel.panel->T_body_panel;
    const auto seen =
        PanelView::make(panel, T_camera_world * T_world_panel, T_world_panel, prepared.scene->lighting);
    if (!seen) continue;
    include(view.bounds, (*seen).bounds());
    view.panels.push_back(*seen);
  }
  return view;
}

InstantView view_instant(const PreparedScene& prepared, const std::vector<std::size_t>& order,
                         const Instants& instants, int index) {
  const Scene& scene = *prepared.scene;
  const double time_s = instants.at(index);
  const Pose T_world_camera = scene.T_world_camera.at(time_s);
  InstantView view;
  view.index = index;
  view.light = static_cast<float>(scene.flicker.light(time_s));
  if (scene.room) view.room = RoomView(*scene.room, T_world_camera);
  const Pose T_camera_world = T_world_camera.inverse();
  for (const std::size_t body : order) {
    view.bodies.push_back(view_body(prepared, prepared.bodies[body], T_camera_world, time_s));
  }
  return view;
}

/// One look of a lens, tile by tile: the picture of each of its instants is put together here before it is
/// added up.
class TileFilm {
 public:
  /// instants: of this look alone. The film is the mean over num_looks such pictures.
  TileFilm(const PreparedScene& prepared, const std::vector<InstantView>& instants,
           const Eigen::Vector2f& offset_px, int num_looks)
      : prepared_(prepared),
        instants_(instants),
        offset_px_(offset_px),
        num_looks_(num_looks),
        weight_(1.0F / static_cast<float>(instants.size())),
        splits_(splits_per_picture(num_looks * static_cast<int>(instants.size()))) {
    for (const InstantView& instant : instants) mean_light_ += weight_ * instant.light;
  }

  void expose(const Tile& tile, Image<float>& out) {
    prepared_.grid.look(tile, offset_px_, look_);
    std::fill_n(sum_, kTileArea, 0.0F);
    if (prepared_.is_camera_fixed) {
      expose_before_fixed_camera();
    } else {
      const int samples = samples_per_picture(num_looks_ * static_cast<int>(instants_.size()));
      for (const InstantView& instant : instants_) {
        draw_room(instant, samples);
        for (const BodyInstant& body : instant.bodies) draw_body(body);
        add(weight_ * instant.light);
      }
    }
    store(tile, out);
  }

 private:
  /// What stands still is drawn once; a tile in which nothing moves is then done.
  void expose_before_fixed_camera() {
    draw_room(instants_[0], samples_per_picture(num_looks_));
    const auto is_moving = [&](const BodyInstant& body) {
      return !body.is_fixed && body.bounds.touches(look_.tile.bounds);
    };
    const bool moves = std::any_of(instants_.begin(), instants_.end(), [&](const InstantView& instant) {
      return std::any_of(instant.bodies.begin(), instant.bodies.end(), is_moving);
    });
    if (!moves) {
      for (const BodyInstant& body : instants_[0].bodies) draw_body(body);
      add(mean_light_);
      return;
    }
    std::copy_n(picture_, kTileArea, backdrop_);
    for (const InstantView& instant : instants_) {
      std::copy_n(backdrop_, kTileArea, picture_);
      for (const BodyInstant& body : instant.bodies) draw_body(body);
      add(weight_ * instant.light);
    }
  }

  void draw_room(const InstantView& instant, int samples) {
    if (prepared_.scene->room) {
      instant.room.draw(look_, samples, instant.index, picture_);
    } else {
      std::fill_n(picture_, kTileArea, 0.0F);
    }
  }

  void draw_body(const BodyInstant& body) {
    if (!body.bounds.touches(look_.tile.bounds)) return;
    bool is_touched = false;
    for (const PanelView& panel : body.panels) {
      if (!panel.bounds().touches(look_.tile.bounds)) continue;
      if (!is_touched) {
        std::fill_n(layer_.colour, kTileArea, 0.0F);
        std::fill_n(layer_.coverage, kTileArea, 0.0F);
      }
      is_touched = true;
      panel.draw(look_, splits_, layer_);
    }
    if (!is_touched) return;
    for (int i = 0; i < kTileArea; ++i) {
      picture_[i] = picture_[i] * (1.0F - std::min(layer_.coverage[i], 1.0F)) + layer_.colour[i];
    }
  }

  void add(float weight) {
    for (int i = 0; i < kTileArea; ++i) sum_[i] += weight * picture_[i];
  }

  void store(const Tile& tile, Image<float>& out) const {
    for (int y = 0; y < tile.height; ++y) {
      std::copy_n(sum_ + y * kTileWidth, tile.width, out.row(tile.y + y) + tile.x);
      if (prepared_.grid.sees_everywhere()) continue;
      for (int x = 0; x < tile.width; ++x) {
        if (!prepared_.grid.is_seen(tile.x + x, tile.y + y)) out(tile.x + x, tile.y + y) = 0.0F;
      }
    }
  }

  const PreparedScene& prepared_;
  const std::vector<InstantView>& instants_;
  const Eigen::Vector2f offset_px_;
  const int num_looks_;
  const float weight_;
  const int splits_;
  float mean_light_ = 0.0F;
  TileLook look_;
  BodyLayer layer_;
  alignas(32) float picture_[kTileArea];
  alignas(32) float backdrop_[kTileArea];
  alignas(32) float sum_[kTileArea];
};

}  // namespace

Image<float> film(const PreparedScene& prepared, const Instants& instants, const Lens& lens) {
  const auto order = drawing_order(prepared, instants.start_s + 0.5 * instants.step_s * instants.count);
  Image<float> seen(prepared.grid.width(), prepared.grid.height(), 0.0F);
  Image<float> blurred(prepared.grid.width(), prepared.grid.height(), 0.0F);
  for (int look = 0; look < lens.num_looks(); ++look) {
    std::vector<InstantView> views;
    for (int i = look; i < instants.count; i += lens.num_looks()) {
      views.push_back(view_instant(prepared, order, instants, i));
    }
    TileFilm tile_film(prepared, views, lens.offset_px(look), lens.num_looks());
    for (const Tile& tile : prepared.grid.tiles()) tile_film.expose(tile, seen);
    lens.add(seen, look, blurred);
  }
  return blurred;
}

}  // namespace apriltrack
