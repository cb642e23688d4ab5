#include "room_painter.h"

#include <algorithm>
#include <cmath>

#include "canvas.h"

namespace apriltrack {
namespace {

constexpr double kWall = 0.50;

void paint_poster(Canvas& canvas, double x, double y, double width, double height, RandomStream& random) {
  const bool is_dark = random.uniform() < 0.4;
  const double ground = is_dark ? random.uniform(0.08, 0.2) : random.uniform(0.55, 0.8);
  const double figure = is_dark ? random.uniform(0.5, 0.8) : random.uniform(0.04, 0.3);
  canvas.rectangle(x - 0.012, y - 0.012, width + 0.024, height + 0.024, random.uniform(0.08, 0.3));
  canvas.rectangle(x, y, width, height, ground);
  switch (static_cast<int>(random.uniform(0.0, 4.0))) {
    case 0:
      canvas.text(x + 0.1 * width, y + 0.08 * height, 0.8 * width, 0.84 * height, 0.022, figure, random);
      break;
    case 1:
      canvas.stripes(x + 0.1 * width, y + 0.1 * height, 0.8 * width, 0.4 * height, 0.09,
                     random.uniform() < 0.5, figure);
      canvas.text(x + 0.1 * width, y + 0.58 * height, 0.8 * width, 0.34 * height, 0.03, figure, random);
      break;
    case 2:
      for (int i = 0; i < 9; ++i) {
        const double grey = random.uniform(0.05, 0.8);
        const double radius = 0.2 * std::min(width, height) * random.uniform(0.3, 1.0);
        const double up = y + height * random.uniform(0.2, 0.8);
        canvas.disc(x + width * random.uniform(0.2, 0.8), up, radius, grey);
      }
      break;
    default:
      for (int i = 0; i < 12; ++i) {
        const double grey = random.uniform(0.04, 0.8);
        const double tall = 0.28 * height * random.uniform(0.2, 1.0);
        const double wide = 0.28 * width * random.uniform(0.2, 1.0);
        const double up = y + height * random.uniform(0.02, 0.7);
        canvas.rectangle(x + width * random.uniform(0.02, 0.7), up, wide, tall, grey);
      }
  }
}

void paint_shelf(Canvas& canvas, double x, double width, RandomStream& random) {
  constexpr double kBoard = 0.025;
  constexpr double kStorey = 0.33;
  canvas.rectangle(x, 0.0, width, 3 * kStorey + kBoard, 0.06);
  for (int storey = 0; storey < 3; ++storey) {
    const double floor = storey * kStorey + kBoard;
    for (double right = x + kBoard; right < x + width - 0.06;) {
      const double book = random.uniform(0.018, 0.055);
      const double height = (kStorey - kBoard) * random.uniform(0.62, 0.94);
      const double cover = random.uniform(0.05, 0.65);
      canvas.rectangle(right, floor, book, height, cover);
      canvas.rectangle(right + 0.2 * book, floor + 0.7 * height, 0.6 * book, 0.03, cover > 0.35 ? 0.1 : 0.6);
      right += book + 0.002;
    }
    canvas.rectangle(x, floor + kStorey - kBoard, width, kBoard, 0.3);
  }
}

void paint_window(Canvas& canvas, double x, double y, double width, double height) {
  canvas.rectangle(x - 0.06, y - 0.06, width + 0.12, height + 0.12, 0.75);
  canvas.rectangle(x, y, width, height, 1.1);
  canvas.rectangle(x, y, width, 0.35 * height, 0.7);
  canvas.rectangle(x + 0.48 * width, y, 0.04 * width, height, 0.7);
  canvas.rectangle(x, y + 0.48 * height, width, 0.03 * height, 0.7);
}

void paint_door(Canvas& canvas, double x) {
  canvas.rectangle(x - 0.05, 0.0, 0.95, 2.1, 0.62);
  canvas.rectangle(x, 0.0, 0.85, 2.05, 0.3);
  for (const double y : {0.2, 1.15}) {
    canvas.rectangle(x + 0.12, y, 0.61, 0.75, 0.24);
    canvas.rectangle(x + 0.14, y + 0.02, 0.57, 0.71, 0.33);
  }
  canvas.rectangle(x + 0.74, 1.0, 0.07, 0.025, 0.75);
}

void paint_wall(Canvas& canvas, int number, RandomStream& random) {
  const double width = canvas.width_m();
  canvas.stripes(0.0, 0.0, width, canvas.height_m(), 0.31, true, kWall * 0.93);  // wallpaper
  canvas.rectangle(0.0, 0.0, width, 0.09, 0.25);                                 // skirting board
  for (double x = random.uniform(0.1, 0.3);
       x < width - 0.3;) {  // posters above and below the height of the tags
    const double poster = random.uniform(0.28, 0.55);
    const double upper_height = random.uniform(0.35, 0.6);
    paint_poster(canvas, x, random.uniform(1.75, 1.95), poster, upper_height, random);
    const double lower_height = random.uniform(0.25, 0.5);
    const double lower_width = random.uniform(0.2, 0.45);
    paint_poster(canvas, x + 0.15, random.uniform(0.55, 0.75), lower_width, lower_height, random);
    x += poster + random.uniform(0.2, 0.45);
  }
  if (number == 0) paint_window(canvas, 0.38 * width, 0.95, 1.1, 1.0);
  if (number == 1) paint_shelf(canvas, 0.3 * width, 1.3, random);
  if (number == 2) paint_door(canvas, 0.7 * width);
  if (number == 3) paint_shelf(canvas, 0.05 * width, 0.9, random);
  for (int i = 0; i < 3; ++i) {
    const double size = random.uniform(0.08, 0.14);
    const double up = random.uniform(0.9, 1.0);
    canvas.false_tag(width * random.uniform(0.1, 0.85), up, size, random);
  }
  for (int i = 0; i < 10; ++i) {  // notes, switches, sockets
    const double grey = random.uniform(0.1, 0.85);
    const double tall = random.uniform(0.03, 0.12);
    const double wide = random.uniform(0.03, 0.1);
    const double up = random.uniform(0.2, 2.2);
    canvas.rectangle(width * random.uniform(0.02, 0.95), up, wide, tall, grey);
  }
}

void paint_floor(Canvas& canvas, RandomStream& random) {
  constexpr double kPlank = 0.12;
  for (double y = 0.0; y < canvas.height_m(); y += kPlank) {
    for (double x = -random.uniform(0.0, 1.2); x < canvas.width_m(); x += 1.2) {
      const double wood = random.uniform(0.2, 0.34);
      canvas.rectangle(x, y, 1.2, kPlank, wood);
      for (int i = 0; i < 6; ++i) canvas.rectangle(x, y + kPlank * random.uniform(), 1.2, 0.004, wood * 0.85);
      canvas.rectangle(x, y, 0.006, kPlank, 0.06);
    }
    canvas.rectangle(0.0, y, canvas.width_m(), 0.005, 0.08);
  }
  const double x = 0.3 * canvas.width_m();
  const double y = 0.3 * canvas.height_m();
  canvas.rectangle(x, y, 0.4 * canvas.width_m(), 0.4 * canvas.height_m(), 0.12);
  canvas.stripes(x + 0.1, y + 0.1, 0.4 * canvas.width_m() - 0.2, 0.4 * canvas.height_m() - 0.2, 0.2, true,
                 0.45);
}

void paint_ceiling(Canvas& canvas, RandomStream& random) {
  constexpr double kTile = 0.6;
  for (double y = 0.0; y < canvas.height_m(); y += kTile) {
    for (double x = 0.0; x < canvas.width_m(); x += kTile) {
      canvas.rectangle(x, y, kTile - 0.015, kTile - 0.015, random.uniform(0.62, 0.7));
      for (int i = 0; i < 25; ++i) {
        const double up = y + kTile * random.uniform();
        canvas.rectangle(x + kTile * random.uniform(), up, 0.009, 0.009, 0.45);
      }
    }
  }
  canvas.rectangle(0.42 * canvas.width_m(), 0.38 * canvas.height_m(), 0.6, 0.6, 1.6);
}

/// The face's texels in the room's order, with the light on them.
Texture bake(const Canvas& canvas, const RoomPlan& plan, const Lighting& lighting, int face) {
  const int axis = face / 2;
  const int a = (axis + 1) % 3;
  const int b = (axis + 2) % 3;
  const Eigen::Vector3d size = plan.max_corner - plan.min_corner;
  const auto texels = [&](int along) { return static_cast<int>(std::ceil(size[along] / plan.texel_m)) + 1; };
  const Eigen::Vector3d inward = (face % 2 == 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(axis);
  const int across = axis == plan.up_axis ? a : 3 - axis - plan.up_axis;

  Image<float> radiance(texels(a), texels(b));
  constexpr int kLightStep = 16;  // light changes slowly: one value for so many texels in a row, interpolated
  for (int row = 0; row < radiance.height(); ++row) {
    Eigen::Vector3d point = face % 2 == 0 ? plan.min_corner : plan.max_corner;
    point[b] = plan.min_corner[b] + (row + 0.5) * plan.texel_m;
    const auto light_at = [&](int column) {
      point[a] = plan.min_corner[a] + (column + 0.5) * plan.texel_m;
      return lighting.irradiance(point, inward);
    };
    double light = light_at(0);
    for (int start = 0; start < radiance.width(); start += kLightStep) {
      const double next = light_at(start + kLightStep);
      for (int i = 0; i < kLightStep && start + i < radiance.width(); ++i) {
        point[a] = plan.min_corner[a] + (start + i + 0.5) * plan.texel_m;
        const Eigen::Vector3d from_corner = point - plan.min_corner;
        double up = from_corner[axis == plan.up_axis ? b : plan.up_axis];
        if (axis != plan.up_axis && plan.up_sign < 0.0) up = size[plan.up_axis] - up;
        radiance(start + i, row) =
            canvas.at(from_corner[across], up) * static_cast<float>(light + (next - light) * i / kLightStep);
      }
      light = next;
    }
  }
  return Texture(std::move(radiance), plan.texel_m);
}

}  // namespace

Room paint_room(const RoomPlan& plan, const Lighting& lighting) {
  Room room{plan.min_corner, plan.max_corner, {}};
  const Eigen::Vector3d size = plan.max_corner - plan.min_corner;
  int wall = 0;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    RandomStream random(plan.seed, 77, static_cast<std::uint64_t>(face));
    const bool is_wall = axis != plan.up_axis;
    const int across = is_wall ? 3 - axis - plan.up_axis : (axis + 1) % 3;
    const int along = is_wall ? plan.up_axis : (axis + 2) % 3;
    Canvas canvas(size[across], size[along], plan.texel_m, kWall);
    const bool is_lower = (face % 2 == 0) == (plan.up_sign > 0.0);
    if (is_wall) {
      paint_wall(canvas, wall++, random);
    } else if (is_lower) {
      paint_floor(canvas, random);
    } else {
      paint_ceiling(canvas, random);
    }
    canvas.grain(0.06, random);
    room.radiance[static_cast<std::size_t>(face)] =
        std::make_shared<const Texture>(bake(canvas, plan, lighting, face));
  }
  return room;
}

}  // namespace apriltrack
