#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/base/error.h"

namespace apriltrack::app {

/// Whether a format of this kind is written; those of a table that does not say are.
template <class Info>
bool is_written(const Info& info) {
  if constexpr (requires { info.is_written; }) return info.is_written;
  return true;
}

template <class Format>
bool can_be_written(const Format& format) {
  if constexpr (requires { info_of(format); }) return is_written(info_of(format));
  return true;
}

/// What --to may be, of one table of formats or of several.
template <class... Tables>
std::vector<std::string> names_of_formats(const Tables&... tables) {
  std::vector<std::string> names;
  const auto add = [&](const auto& table) {
    for (const auto& info : table)
      if (is_written(info)) names.emplace_back(info.name);
  };
  (add(tables), ...);
  return names;
}

/// "ros (ROS camera_info YAML), ...".
template <class... Tables>
std::string list_of_formats(const Tables&... tables) {
  std::string list;
  const auto add = [&](const auto& table) {
    for (const auto& info : table)
      if (is_written(info)) list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", info.name, info.title);
  };
  (add(tables), ...);
  return list;
}

/// The format of an output: the one that --to names, else the one that the ending of OUT tells. named,
/// of_ending: a std::optional of a format for a name. known: list_of_formats(). Throws Error(kInvalidInput).
template <class Named, class OfEnding>
auto format_to_write(const std::string& to, const std::string& output, const Named& named,
                     const OfEnding& of_ending, std::string_view known) {
  const auto format = to.empty() ? of_ending(output) : named(to);
  if (format && (to.empty() || can_be_written(*format))) return *format;
  if (to.empty())
    throw invalid_input(
        "--to", fmt::format("is required: the ending of '{}' does not say which format; there are {}", output,
                            known));
  throw invalid_input("--to",
                      fmt::format("'{}' is {}; there are {}", to,
                                  format ? "a format that is read, not written" : "no known format", known));
}

}  // namespace apriltrack::app
