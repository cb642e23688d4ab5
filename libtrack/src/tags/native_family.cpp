#include "native_family.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

#include "apriltrack/base/error.h"
#include "family_source.h"

namespace apriltrack {
namespace {

constexpr const char* kTwoCellBorderName = "tag36h11b2";

/// Kalibr prints the codes of 36h11 within a black border of two cells, so that the square whose corners are
/// detected is ten cells wide and every bit lies one cell further in.
apriltag_family* create_two_cell_border_36h11() {
  char* name = ::strdup(kTwoCellBorderName);
  if (!name) throw std::bad_alloc();
  apriltag_family* family = tag36h11_create();
  std::free(family->name);
  family->name = name;
  family->width_at_border += 2;
  family->total_width += 2;
  for (std::uint32_t i = 0; i < family->nbits; ++i) {
    ++family->bit_x[i];
    ++family->bit_y[i];
  }
  return family;
}

constexpr std::array kSources = {
    FamilySource{"tag16h5", tag16h5_create, tag16h5_destroy},
    FamilySource{"tag25h9", tag25h9_create, tag25h9_destroy},
    FamilySource{"tag36h10", tag36h10_create, tag36h10_destroy},
    FamilySource{"tag36h11", tag36h11_create, tag36h11_destroy},
    FamilySource{kTwoCellBorderName, create_two_cell_border_36h11, tag36h11_destroy},
    FamilySource{"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
    FamilySource{"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
    FamilySource{"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
    FamilySource{"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    FamilySource{"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
};

}  // namespace

std::span<const FamilySource> family_sources() {
  return kSources;
}

const FamilySource* find_family_source(std::string_view name) {
  const auto source = std::ranges::find(kSources, name, &FamilySource::name);
  return source == kSources.end() ? nullptr : &*source;
}

std::string unknown_family_message(std::string_view name) {
  std::string known;
  for (const FamilySource& source : kSources) known += (known.empty() ? "" : ", ") + std::string(source.name);
  return fmt::format("unknown tag family '{}' (known: {})", name, known);
}

void NativeFamilyDeleter::operator()(apriltag_family* family) const {
  const FamilySource* source = find_family_source(family->name);
  if (source) source->destroy(family);
}

NativeFamily make_native_family(std::string_view name) {
  const FamilySource* source = find_family_source(name);
  if (!source) throw invalid_input("", unknown_family_message(name));
  return NativeFamily(source->create());
}

}  // namespace apriltrack
