#include "stamped_messages.h"

#include <utility>

namespace apriltrack {
namespace {

constexpr std::size_t kMostAhead = 5;
/// Times of recording tremble by about so much; to look ahead in vain costs little.
constexpr double kLeastJump_s = 0.1;

}  // namespace

void StampedMessage::keep() {
  if (std::exchange(is_kept_, true)) return;
  kept_ = view_;
}

std::optional<StampedMessage> StampedMessages::read() {
  const auto message = reader_.next();
  if (!message) return std::nullopt;
  return StampedMessage(*message, message->error.empty() ? read_stamp_(message->bytes) : std::nullopt);
}

std::optional<StampedMessage> StampedMessages::next() {
  if (ahead_.empty()) return read();
  StampedMessage message = std::move(ahead_.front());
  ahead_.erase(ahead_.begin());
  return message;
}

bool StampedMessages::pass_over() {
  if (ahead_.empty()) return reader_.pass_over();
  ahead_.erase(ahead_.begin());
  return true;
}

const std::vector<StampedMessage>& StampedMessages::look_ahead(StampedMessage& current) {
  current.keep();
  while (ahead_.size() < kMostAhead) {
    auto message = read();
    if (!message) break;
    message->keep();
    ahead_.push_back(*std::move(message));
  }
  return ahead_;
}

bool StampCourse::jumps_ahead(const StampedMessage& message) const {
  if (!stamp_ || !message.stamp) return true;
  return seconds_between(*stamp_, *message.stamp) >
         seconds_between(*log_time_, message.log_time) + kLeastJump_s;
}

bool StampCourse::is_wrong(Timestamp stamp, const std::vector<StampedMessage>& ahead) {
  std::size_t num_stamps = 0, num_before = 0;
  for (const StampedMessage& message : ahead) {
    if (!message.has_time()) continue;
    ++num_stamps;
    num_before += *message.stamp <= stamp;
  }
  return 2 * num_before > num_stamps;
}

Timestamp StampCourse::first_time(const StampedMessage& first, const std::vector<StampedMessage>& ahead) {
  std::optional<Timestamp> earliest;
  for (const StampedMessage& message : ahead)
    if (message.has_time() && (!earliest || *message.stamp < *earliest)) earliest = message.stamp;
  if (!earliest) return first.log_time;
  // 1 ns for each frame that follows without a time.
  return {earliest->ns - static_cast<std::int64_t>(ahead.size()) - 1};
}

void StampCourse::believe(const StampedMessage& message) {
  stamp_ = message.stamp;
  log_time_ = message.log_time;
}

}  // namespace apriltrack
