#include "apriltrack/export/export_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/staged_files.h"
#include "apriltrack/tags/map_holdings.h"
#include "export_words.h"
#include "writers.h"

namespace apriltrack {
namespace {

namespace fs = std::filesystem;

constexpr NameEnding kGltf[] = {{".gltf", true}};
constexpr NameEnding kGlb[] = {{".glb", true}};
constexpr NameEnding kUrdf[] = {{".urdf", true}};
constexpr NameEnding kSdf[] = {{".sdf", true}};
constexpr NameEnding kG2o[] = {{".g2o", true}};
constexpr NameEnding kCsv[] = {{".csv"}};
constexpr NameEnding kJson[] = {{".json"}};

constexpr std::array<ExportFormatInfo, 8> kExportFormats = {
    {{ExportFormat::kGltf, "gltf", "glTF scene", kGltf},
     {ExportFormat::kGlb, "glb", "binary glTF scene", kGlb},
     {ExportFormat::kUrdf, "urdf", "URDF robot", kUrdf},
     {ExportFormat::kSdf, "sdf", "SDFormat model", kSdf},
     {ExportFormat::kColmap, "colmap", "COLMAP text model", {}, true},
     {ExportFormat::kG2o, "g2o", "g2o graph", kG2o},
     {ExportFormat::kCornersCsv, "corners-csv", "table of corners (CSV)", kCsv},
     {ExportFormat::kCornersJson, "corners-json", "table of corners (JSON)", kJson}}};

/// Where a covariance has no inverse, g2o's information cannot tell it.
std::string g2o_text_of(const TagMap& map, std::vector<ConversionLoss>& losses) {
  std::vector<std::string> left_out;
  std::string text = g2o_text(map, left_out);
  if (!left_out.empty())
    losses.push_back(
        {.kind = LossKind::kCovariance, .which = std::move(left_out), .value = "they have no inverse"});
  return text;
}

std::vector<ExportedFile> files_of(const TagMap& map, ExportFormat format,
                                   std::vector<ConversionLoss>& losses) {
  switch (format) {
    case ExportFormat::kGltf:
      return {{"", gltf_text(map)}};
    case ExportFormat::kGlb:
      return {{"", glb_bytes(map)}};
    case ExportFormat::kUrdf:
      return {{"", urdf_text(map)}};
    case ExportFormat::kSdf:
      return {{"", sdf_text(map)}};
    case ExportFormat::kColmap:
      return colmap_files(map);
    case ExportFormat::kG2o:
      return {{"", g2o_text_of(map, losses)}};
    case ExportFormat::kCornersCsv:
      return {{"", corners_csv(map)}};
    case ExportFormat::kCornersJson:
      return {{"", corners_json(map)}};
  }
  return {};
}

MapHoldings holdings_of(ExportFormat format) {
  const bool is_graph = format == ExportFormat::kG2o;
  return {.sizes = !is_graph,
          .families = true,
          .covariances = is_graph,
          .frame_name = format != ExportFormat::kCornersCsv && format != ExportFormat::kColmap && !is_graph};
}

}  // namespace

std::span<const ExportFormatInfo> export_formats() {
  return kExportFormats;
}

const ExportFormatInfo& info_of(ExportFormat format) {
  const auto found = std::ranges::find(kExportFormats, format, &ExportFormatInfo::format);
  APRILTRACK_CHECK(found != kExportFormats.end(), "every format is in the table");
  return *found;
}

std::optional<ExportFormat> export_format_named(std::string_view name) {
  const auto found = std::ranges::find(kExportFormats, name, &ExportFormatInfo::name);
  return found == kExportFormats.end() ? std::nullopt : std::optional(found->format);
}

MapExport export_tag_map(const TagMap& map, ExportFormat format) {
  MapExport result;
  result.files = files_of(map, format, result.losses);
  add_left_out(map, holdings_of(format), result.losses);
  const bool has_plain_names = format == ExportFormat::kUrdf || format == ExportFormat::kSdf;
  if (const std::string name = plain_frame_name(map); has_plain_names && name != map.frame)
    result.losses.push_back({.kind = LossKind::kFrameName, .how = LossHow::kConverted, .value = name});
  return result;
}

std::vector<ConversionLoss> write_exported_map(const fs::path& path, const TagMap& map, ExportFormat format) {
  check_tag_map(map, path.string());
  if (format == ExportFormat::kColmap) check_colmap_folder(path);
  MapExport result = export_tag_map(map, format);
  if (!info_of(format).is_folder) {
    write_file_atomically(path, result.files.front().contents);
    return std::move(result.losses);
  }
  StagedFiles staged;
  staged.make_folder(path);
  for (const ExportedFile& file : result.files)
    staged.write(path / file.name,
                 [&](const fs::path& aside) { write_file_atomically(aside, file.contents); });
  staged.commit();
  return std::move(result.losses);
}

}  // namespace apriltrack
