#include "left_out_words.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace apriltrack::app {
namespace {

const char* word_of(LeftOutReason reason) {
  switch (reason) {
    case LeftOutReason::kEdgesNotFitted:
      return "edges_not_fitted";
    case LeftOutReason::kMayBeChance:
      return "may_be_chance";
  }
  return "";
}

}  // namespace

std::string told_after(const LeftOutTags& left_out) {
  return left_out.is_empty() ? "" : "; " + left_out.message();
}

nlohmann::json json_of(const LeftOutTags& left_out) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& [reason, readings] : left_out.by_reason()) {
    nlohmann::json tags = nlohmann::json::array();
    for (const TagKey& tag : readings.tags) tags.push_back(to_string(tag));
    list.push_back({{"reason", word_of(reason)}, {"readings", readings.count}, {"tags", tags}});
  }
  return list;
}

}  // namespace apriltrack::app
