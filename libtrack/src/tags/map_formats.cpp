#include "apriltrack/tags/map_formats.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "formats/formats.h"

namespace apriltrack {
namespace {

const MapFormatCode& code_of(MapFormat format) {
  const auto& codes = map_format_codes();
  const auto found =
      std::ranges::find(codes, format, [](const MapFormatCode& code) { return code.info.format; });
  APRILTRACK_CHECK(found != codes.end(), "every format has its code");
  return *found;
}

[[noreturn]] void fail_unknown(const MapText& text) {
  std::string known;
  for (const MapFormatInfo& format : map_formats())
    known += fmt::format("{}{} ({})", known.empty() ? "" : "; ", format.title, format.marker);
  const std::string what = "is no layout of tags that is known; known are: " + known;
  // What has everything but its mark is one of ours.
  if (text.root && text.root->is_map() && text.root->find("frame") && text.root->find("tags"))
    text.root->fail("'apriltrack_map' is missing: a tag map begins with 'apriltrack_map: 1'");
  if (text.root) text.root->fail(what);
  throw invalid_input(text.file, what);
}

const MapFormatCode& recognised_code(const MapText& text) {
  for (const MapFormatCode& code : map_format_codes()) {
    if (code.recognises(text)) return code;
  }
  fail_unknown(text);
}

}  // namespace

std::span<const MapFormatInfo> map_formats() {
  static const std::vector<MapFormatInfo> infos = [] {
    std::vector<MapFormatInfo> all;
    for (const MapFormatCode& code : map_format_codes()) all.push_back(code.info);
    return all;
  }();
  return infos;
}

const MapFormatInfo& info_of(MapFormat format) {
  return code_of(format).info;
}

std::optional<MapFormat> map_format_named(std::string_view name) {
  const auto found = std::ranges::find(map_formats(), name, &MapFormatInfo::name);
  return found == map_formats().end() ? std::nullopt : std::optional(found->format);
}

std::optional<MapFormat> map_format_of_ending(const std::filesystem::path& path) {
  return format_of_ending(map_formats(), path);
}

namespace {

/// Who chooses a bundle means it.
void refuse_bundle_where_none(const MapText& text, const MapFormatInfo& info, const MapReadOptions& options) {
  using enum MapFormat;
  const bool has_bundles =
      info.format == kAprilTagRos || info.format == kAprilTagRos2 || info.format == kTagSlam;
  if (has_bundles || options.bundle.empty() || options.only_where_missing) return;
  throw invalid_input(text.file, fmt::format("this {} has no bundles to choose '{}' from (--bundle)",
                                             info.title, options.bundle));
}

MapReading read_by(const MapFormatCode& code, const MapText& text, const MapReadOptions& options) {
  refuse_bundle_where_none(text, code.info, options);
  return code.read(text, options);
}

}  // namespace

MapFormat recognise_map_format(const std::filesystem::path& path) {
  return recognised_code(load_map_text(path)).info.format;
}

MapReading read_tag_map(const std::filesystem::path& path, const MapReadOptions& options) {
  const MapText text = load_map_text(path);
  return read_by(recognised_code(text), text, options);
}

MapReading read_tag_map_as(const std::filesystem::path& path, MapFormat format,
                           const MapReadOptions& options) {
  const MapText text = load_map_text(path);
  const MapFormatCode& code = code_of(format);
  if (!code.recognises(text))
    throw invalid_input(text.file, fmt::format("is no {} ({})", code.info.title, code.info.marker));
  return read_by(code, text, options);
}

TagMap read_tag_map(const std::filesystem::path& path) {
  return read_tag_map(path, MapReadOptions()).map;
}

std::vector<ConversionLoss> write_tag_map_as(const std::filesystem::path& path, const TagMap& map,
                                             MapFormat format, const MapWriteOptions& options) {
  check_tag_map(map, path.string());  // what could not be read again must not be written
  std::vector<ConversionLoss> losses;
  const std::string text = code_of(format).write(map, options, path.string(), losses);
  write_file_atomically(path, text);
  return losses;
}

}  // namespace apriltrack
