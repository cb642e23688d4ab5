#include "apriltrack/tags/tag_family.h"

#include <apriltag/apriltag.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <mutex>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "family_source.h"
#include "native_family.h"

namespace apriltrack {
namespace {

constexpr float kBlack = 0.0F;
constexpr float kWhite = 1.0F;
constexpr float kNotPrinted = std::numeric_limits<float>::quiet_NaN();

/// The decoder's table holds every code with every pattern of up to `max_corrected_bits` wrong bits: with 2
/// bits and AprilTag 3.3 the families of over 40,000 codes take 4.5 to 7.2 GB and 8 to 13 s to build.
constexpr int kMaxCodesForTwoBits = 5000;

/// A cell without a data bit. x, y: cell within the square whose corners the detector reports.
float border_cell(int x, int y, int width_at_border, bool has_reversed_border) {
  const int ring = std::min({x, y, width_at_border - 1 - x, width_at_border - 1 - y});
  if (!has_reversed_border) return ring >= 0 ? kBlack : kWhite;
  // One white ring inside the detected square, one black ring round it. The other cells without data are left
  // to the printer: the corners of circle families, the middle of tagCustom48h12.
  if (ring == 0) return kWhite;
  return ring == -1 ? kBlack : kNotPrinted;
}

}  // namespace

/// Families by their place in family_sources(), each built when it is first asked for.
class TagFamilyTable {
 public:
  static const TagFamily& at(std::size_t index) {
    static TagFamilyTable table;
    Slot& slot = table.slots_[index];
    std::call_once(slot.built, [&] { slot.family = build(family_sources()[index].name); });
    return *slot.family;
  }

 private:
  struct Slot {
    std::once_flag built;
    std::unique_ptr<const TagFamily> family;
  };

  static std::unique_ptr<const TagFamily> build(std::string_view name);

  std::deque<Slot> slots_{family_sources().size()};
};

std::unique_ptr<const TagFamily> TagFamilyTable::build(std::string_view name) {
  const NativeFamily native = make_native_family(name);
  std::unique_ptr<TagFamily> family(new TagFamily());
  family->name_ = name;
  family->num_codes_ = static_cast<int>(native->ncodes);
  family->width_at_border_ = native->width_at_border;
  family->total_width_ = native->total_width;
  family->has_reversed_border_ = native->reversed_border;
  family->max_corrected_bits_ = family->num_codes_ > kMaxCodesForTwoBits ? 1 : 2;
  family->codes_.assign(native->codes, native->codes + native->ncodes);
  for (std::uint32_t i = 0; i < native->nbits; ++i) {
    family->bit_cells_.emplace_back(static_cast<int>(native->bit_x[i]), static_cast<int>(native->bit_y[i]));
  }
  return family;
}

TagPattern::TagPattern(Image<float> cells, int width_at_border)
    : cells_(std::move(cells)), width_at_border_(width_at_border) {
  APRILTRACK_CHECK(cells_.width() == cells_.height() && !cells_.is_empty(),
                   "the cells of a tag form a square");
  APRILTRACK_CHECK(
      width_at_border > 0 && width_at_border <= cells_.width() && (cells_.width() - width_at_border) % 2 == 0,
      "the border square lies centred within the cells");
}

double TagPattern::half_extent() const {
  return static_cast<double>(cells_.width()) / width_at_border_;
}

double TagPattern::brightness(double u, double v) const {
  const double extent = half_extent();
  if (!(std::abs(u) < extent && std::abs(v) < extent)) return kWhite;
  const double scale = 0.5 * width_at_border_;
  // Rounding may carry a point just inside the edge to the width itself.
  const int last = cells_.width() - 1;
  const int x = std::min(static_cast<int>((u + extent) * scale), last);
  const int y = std::min(static_cast<int>((v + extent) * scale), last);
  const float cell = cells_(x, y);
  return std::isnan(cell) ? kWhite : cell;
}

const TagFamily& TagFamily::get(std::string_view name) {
  const FamilySource* source = find_family_source(name);
  if (!source) throw invalid_input("", unknown_family_message(name));
  return TagFamilyTable::at(static_cast<std::size_t>(source - family_sources().data()));
}

std::span<const std::string_view> TagFamily::names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> list;
    for (const FamilySource& source : family_sources()) list.push_back(source.name);
    return list;
  }();
  return names;
}

bool TagFamily::is_known(std::string_view name) {
  return find_family_source(name) != nullptr;
}

double TagFamily::chance_of_reading(int corrected_bits) const {
  double patterns = 0.0;  // that are read as one code
  double choices = 1.0;   // C(bits, k)
  for (int k = 0; k <= corrected_bits; ++k) {
    patterns += choices;
    choices *= static_cast<double>(num_bits() - k) / (k + 1);
  }
  constexpr double kTurns = 4.0;
  return std::ldexp(kTurns * num_codes_ * patterns, -num_bits());
}

TagPattern TagFamily::pattern(int id) const {
  APRILTRACK_CHECK(id >= 0 && id < num_codes_,
                   fmt::format("{} has ids 0 to {} (asked for {})", name_, num_codes_ - 1, id));
  const int margin = (total_width_ - width_at_border_) / 2;
  Image<float> cells(total_width_, total_width_);
  for (int y = 0; y < total_width_; ++y) {
    for (int x = 0; x < total_width_; ++x) {
      cells(x, y) = border_cell(x - margin, y - margin, width_at_border_, has_reversed_border_);
    }
  }
  // The first bit is the most significant one in use.
  std::uint64_t bit = std::uint64_t{1} << bit_cells_.size();
  for (const Eigen::Vector2i& cell : bit_cells_) {
    bit >>= 1;
    cells(cell.x() + margin, cell.y() + margin) =
        (codes_[static_cast<std::size_t>(id)] & bit) ? kWhite : kBlack;
  }
  return TagPattern(std::move(cells), width_at_border_);
}

}  // namespace apriltrack
