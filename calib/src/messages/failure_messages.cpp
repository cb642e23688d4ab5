#include "messages/failure_messages.h"

#include <fmt/format.h>

#include "hypotheses/part_failure.h"
#include "messages/tag_messages.h"

namespace apriltrack {
namespace {

std::string cause_of_held_tag(const Observations& observations, const HeldTagAtFault& error) {
  const std::string fault = error.finding() ? message_of(observations, *error.finding())
                                            : fmt::format("The views of {} contradict those of all others",
                                                          to_string(key_of(observations, error.tag())));
  return fmt::format("no map is held by a tag that is at fault. {}. Mend it, or hold another tag", fault);
}

std::string cause_after(const Observations& observations, const NothingLeft& error) {
  std::string faults;
  for (const TagFinding& finding : error.findings()) faults += message_of(observations, finding) + ". ";
  return faults + (faults.empty() ? "" : "Then ") + error.why();
}

}  // namespace

std::string cause_of(const Observations& observations, const Error& error) {
  if (const auto* held = dynamic_cast<const HeldTagAtFault*>(&error))
    return cause_of_held_tag(observations, *held);
  if (const auto* left = dynamic_cast<const NothingLeft*>(&error)) return cause_after(observations, *left);
  return std::string(error.cause());
}

}  // namespace apriltrack
