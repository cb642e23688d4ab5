#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/io/name_ending.h"
#include "cli/console.h"

namespace apriltrack::app {

/// A format that a command writes.
struct OfferedFormat {
  std::string_view name;   ///< As `--to` takes it.
  std::string_view title;  ///< In a sentence.
  std::span<const NameEnding> endings;
};

/// Whether a format of this kind is written; those of a table that does not say are.
template <class Format>
bool is_written(const Format& format) {
  if constexpr (requires { info_of(format).is_written; }) return info_of(format).is_written;
  return true;
}

/// Those of one table, or of several, that are written.
template <class... Tables>
std::vector<OfferedFormat> offered_formats(const Tables&... tables) {
  std::vector<OfferedFormat> offered;
  const auto add = [&](const auto& table) {
    for (const auto& info : table)
      if (is_written(info.format)) offered.push_back({info.name, info.title, info.endings});
  };
  (add(tables), ...);
  return offered;
}

std::vector<std::string> names_of(const std::vector<OfferedFormat>& formats);
/// "ros (ROS camera_info YAML), ...".
std::string list_of(const std::vector<OfferedFormat>& formats);

/// Where neither --to nor the ending of OUT tells a format that is written.
[[noreturn]] void fail_without_format(const std::string& to, const std::string& output, bool is_known,
                                      const std::vector<OfferedFormat>& formats);

/// The format of an output: the one that --to names, else the one that the ending of OUT tells. named,
/// of_ending: a std::optional of a format for a name. Throws Error(kInvalidInput).
template <class Named, class OfEnding>
auto format_to_write(const std::string& to, const std::string& output, const Named& named,
                     const OfEnding& of_ending, const std::vector<OfferedFormat>& formats) {
  const auto format = to.empty() ? of_ending(output) : named(to);
  if (!format || !is_written(*format)) fail_without_format(to, output, format.has_value(), formats);
  return *format;
}

/// Holds the name of an output against the format that an option asks for. An ending that is another format's
/// alone would mislead every reader: Error(kInvalidInput). One that several formats share, none of them this,
/// is warned of. format: its name.  option: "--to".
void check_ending(const std::string& output, std::string_view format,
                  const std::vector<OfferedFormat>& formats, std::string_view option, const Console& console);

}  // namespace apriltrack::app
