#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/bag/bag_reader.h"

namespace apriltrack {

/// A message of a topic and the time that it tells.
class StampedMessage {
 public:
  StampedMessage() = default;
  StampedMessage(const BagMessage& message, std::optional<Timestamp> told)
      : log_time(message.log_time), error(message.error), stamp(told), view_(message.bytes) {}

  Timestamp log_time;
  std::string error;               ///< Why it could not be read; empty for a good one.
  std::optional<Timestamp> stamp;  ///< nullopt where it cannot be read.

  /// 0 is ROS's word for no time.
  bool has_time() const { return stamp && *stamp != Timestamp{}; }
  /// Valid until the reader moves on, unless they are kept.
  std::string_view bytes() const { return is_kept_ ? std::string_view(kept_) : view_; }
  void keep();

 private:
  bool is_kept_ = false;
  std::string kept_;
  std::string_view view_;
};

/// The messages that a reader was told to give, one after the other. A few may be looked at ahead.
class StampedMessages {
 public:
  using ReadStamp = std::function<std::optional<Timestamp>(std::string_view bytes)>;
  /// reader: outlives this object.
  StampedMessages(BagReader& reader, ReadStamp read_stamp)
      : reader_(reader), read_stamp_(std::move(read_stamp)) {}

  std::optional<StampedMessage> next();
  /// Leaves one out; false at the end.
  bool pass_over();
  /// The five messages that come next, fewer at the end. current: the message given last, which is kept.
  const std::vector<StampedMessage>& look_ahead(StampedMessage& current);

 private:
  std::optional<StampedMessage> read();

  BagReader& reader_;
  ReadStamp read_stamp_;
  std::vector<StampedMessage> ahead_;
};

/// Tells a stamp that is wrong by the messages after it. A stamp that goes back is impossible, but where one
/// jumped ahead before, that was the wrong one, and not its followers.
class StampCourse {
 public:
  /// Whether time ran further since the last stamp that was believed than the times of recording say; also
  /// of the first one. Then is_wrong() is to be asked.
  bool jumps_ahead(const StampedMessage& message) const;
  /// Whether most of the stamps after it lie before it.
  static bool is_wrong(Timestamp stamp, const std::vector<StampedMessage>& ahead);
  /// For the first message, where it has none: one before those that follow.
  static Timestamp first_time(const StampedMessage& first, const std::vector<StampedMessage>& ahead);
  void believe(const StampedMessage& message);

 private:
  std::optional<Timestamp> stamp_, log_time_;
};

}  // namespace apriltrack
