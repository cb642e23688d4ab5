// Where rays meet the plane of a tag, and the texels there. Compiled once for each instruction set.
#if defined(APRILTRACK_PHOTOMETRIC_TEXEL_MEETING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef APRILTRACK_PHOTOMETRIC_TEXEL_MEETING_INL_H_
#undef APRILTRACK_PHOTOMETRIC_TEXEL_MEETING_INL_H_
#else
#define APRILTRACK_PHOTOMETRIC_TEXEL_MEETING_INL_H_
#endif

#include <cstdint>

#include "pixel_kernels.h"
#include "vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {

/// The four texels around each of many places.
struct TexelQuads {
  W top_left, top_right, bottom_left, bottom_right;
};

static HWY_INLINE TexelQuads load_quads(const TexelGrid& grid, I index) {
  HWY_ALIGN std::int32_t at[kLanes];
  hn::Store(index, ints, at);
  const WordPairs above = load_pairs(grid.texels, at), below = load_pairs(grid.texels + grid.width, at);
  return {above.first, above.second, below.first, below.second};
}

static HWY_INLINE V light_of(W texel) {
  return hn::ConvertTo(d, hn::BitCast(ints, hn::And(texel, hn::Set(words, 0xFFFFU))));
}
static HWY_INLINE V presence_of(W texel) {
  return hn::ConvertTo(d, hn::BitCast(ints, hn::ShiftRight<16>(texel)));
}

/// Values at the corners of a cell of texels, as a + x dx + y (dy + x dxy).
struct Bilinear {
  V a, dx, dy, dxy;
  HWY_INLINE V at(V x, V y) const { return hn::MulAdd(y, hn::MulAdd(x, dxy, dy), hn::MulAdd(x, dx, a)); }
  HWY_INLINE V by_x(V y) const { return hn::MulAdd(y, dxy, dx); }
  HWY_INLINE V by_y(V x) const { return hn::MulAdd(x, dxy, dy); }
};

static HWY_INLINE Bilinear bilinear(V top_left, V top_right, V bottom_left, V bottom_right) {
  const V dx = hn::Sub(top_right, top_left), dy = hn::Sub(bottom_left, top_left);
  return {top_left, dx, dy, hn::Sub(hn::Sub(bottom_right, bottom_left), dx)};
}

/// Where the rays meet the plane at one instant.
struct Meeting {
  V column, row, depth;  ///< Zero texels where they miss the texture.
  V fx, fy;              ///< Within the texel.
  hn::Mask<Floats> is_inside;
  Bilinear light, presence;
};

static HWY_INLINE Meeting meet(const TexelGrid& grid, const TexelInstant& instant, V x, V y) {
  const float* N = instant.texel_from_ray.data();
  Meeting at{};
  at.depth = reciprocal(row_of(N + 6, x, y));
  const V column = hn::Mul(at.depth, row_of(N, x, y)), row = hn::Mul(at.depth, row_of(N + 3, x, y));
  const V zero = hn::Zero(d);
  at.is_inside = hn::And(hn::And(hn::And(hn::Ge(column, zero), hn::Ge(row, zero)), hn::Gt(at.depth, zero)),
                         hn::And(hn::Lt(column, all(grid.last_column)), hn::Lt(row, all(grid.last_row))));
  at.column = hn::IfThenElseZero(at.is_inside, column);
  at.row = hn::IfThenElseZero(at.is_inside, row);
  const V left = hn::Floor(at.column), top = hn::Floor(at.row);
  at.fx = hn::Sub(at.column, left);
  at.fy = hn::Sub(at.row, top);
  // Exact: textures have fewer than kMaxSmall texels.
  const I index = small_int(hn::MulAdd(top, all(static_cast<float>(grid.width)), left));
  const TexelQuads quads = load_quads(grid, index);
  at.light = bilinear(light_of(quads.top_left), light_of(quads.top_right), light_of(quads.bottom_left),
                      light_of(quads.bottom_right));
  at.presence = bilinear(presence_of(quads.top_left), presence_of(quads.top_right),
                         presence_of(quads.bottom_left), presence_of(quads.bottom_right));
  return at;
}

}  // namespace HWY_NAMESPACE
}  // namespace apriltrack
HWY_AFTER_NAMESPACE();

#endif
