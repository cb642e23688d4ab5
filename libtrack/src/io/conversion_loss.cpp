#include "apriltrack/io/conversion_loss.h"

#include <array>

namespace apriltrack {
namespace {

constexpr std::array<std::string_view, 25> kKindNames = {
    "sizes",        "families",   "covariance", "tags",       "frame_name",      "origin",     "field_size",
    "matrix_order", "provenance", "statistics", "extensions", "foreign_keys",    "resolution", "response",
    "exposure",     "line_delay", "extrinsics", "names",      "further_cameras", "skew",       "lens_terms",
    "unread_lens",  "times",      "velocities", "biases"};
constexpr std::array<std::string_view, 5> kHowNames = {"left_out", "assumed", "given", "converted",
                                                       "unknown"};
static_assert(kKindNames.size() == static_cast<std::size_t>(LossKind::kBiases) + 1);
static_assert(kHowNames.size() == static_cast<std::size_t>(LossHow::kUnknown) + 1);

}  // namespace

std::string_view to_string(LossKind kind) {
  return kKindNames.at(static_cast<std::size_t>(kind));
}

std::string_view to_string(LossHow how) {
  return kHowNames.at(static_cast<std::size_t>(how));
}

}  // namespace apriltrack
