#include "format_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/io/staged_files.h"

namespace apriltrack::app {
namespace {

/// The first of the format's endings that the name has; nullptr where it has none.
const NameEnding* ending_of(const std::string& output, const OfferedFormat& format) {
  const auto found =
      std::ranges::find_if(format.endings, [&](const NameEnding& one) { return one.is_of(output); });
  return found == format.endings.end() ? nullptr : &*found;
}

}  // namespace

std::vector<std::string> names_of(const std::vector<OfferedFormat>& formats) {
  std::vector<std::string> names;
  for (const OfferedFormat& format : formats) names.emplace_back(format.name);
  return names;
}

std::string list_of(const std::vector<OfferedFormat>& formats) {
  std::string list;
  for (const OfferedFormat& format : formats)
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", format.name, format.title);
  return list;
}

void fail_without_format(const std::string& to, const std::string& output, bool is_known,
                         const std::vector<OfferedFormat>& formats) {
  if (to.empty())
    throw invalid_input(
        "--to", fmt::format("is required: the ending of '{}' does not say which format; there are {}", output,
                            list_of(formats)));
  throw invalid_input("--to", fmt::format("'{}' is {}; there are {}", to,
                                          is_known ? "a format that is read, not written" : "no known format",
                                          list_of(formats)));
}

void check_ending(const std::string& output, std::string_view format,
                  const std::vector<OfferedFormat>& formats, std::string_view option,
                  const Console& console) {
  if (is_written_directly(output)) return;
  std::vector<std::string_view> owners;
  const NameEnding* ending = nullptr;
  for (const OfferedFormat& one : formats) {
    const NameEnding* own = ending_of(output, one);
    if (!own) continue;
    ending = own;
    owners.push_back(one.name);
  }
  if (!ending || std::ranges::find(owners, format) != owners.end()) return;
  if (owners.size() == 1 && !ending->is_common)
    throw invalid_input(option,
                        fmt::format("{} is not what {} in '{}' says, which is {}'s alone: name a file "
                                    "that ends otherwise, or give {} {}",
                                    format, ending->ending, output, owners.front(), option, owners.front()));
  console.warning(
      fmt::format("'{}' is written as {} says, {}, though its name ends in {} as files of other "
                  "formats do: readers that go by the name will not know it",
                  output, option, format, ending->ending));
}

}  // namespace apriltrack::app
