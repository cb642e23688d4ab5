#include "damage.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace apriltrack {
namespace {

std::string counted(std::size_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

void Damage::Kind::add(std::uint64_t offset, std::string_view reason) {
  if (count++ > 0) return;
  first = offset;
  why = reason;
}

std::string Damage::summary() const {
  std::vector<std::string> parts;
  if (is_cut_) parts.push_back(fmt::format("it ends within the record at byte {}", cut_));
  const auto tell = [&](const Kind& kind, std::string_view what, std::string_view verb) {
    if (kind.count == 0) return;
    parts.push_back(fmt::format("{} {} (the first, at byte {}: {})", counted(kind.count, what), verb,
                                kind.first, kind.why));
  };
  tell(chunks_, "chunk", "cannot be read");
  tell(hurt_, "chunk", "can be read in part only");
  tell(headers_, "chunk", "can be read in spite of a wrong header");
  tell(messages_, "message", "cannot be read");
  if (places_.count > 0)
    parts.push_back(fmt::format("{} bytes in {} (the first at byte {}) are no records", num_bytes_,
                                counted(places_.count, "place"), places_.first));
  if (parts.empty() && !has_no_index_) return "";
  const std::string index =
      has_no_index_ ? "it has no whole index, as of a recording that was not closed; what is there was found "
                      "by reading it from the beginning"
                    : "";
  if (parts.empty()) return index;
  return fmt::format("{}{}{}", fmt::join(parts, "; "), index.empty() ? "" : "; ", index);
}

}  // namespace apriltrack
