#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/base/error.h"
#include "apriltrack/source/bag_input.h"
#include "bag_topics.h"
#include "forward_clock.h"
#include "image_inputs.h"
#include "image_names.h"
#include "picture_message.h"
#include "picture_scaling.h"
#include "pipe_input.h"
#include "stamped_messages.h"
#include "video_source.h"

namespace apriltrack {
namespace {

std::optional<Timestamp> read_stamp(const BagTopic& topic, std::string_view bytes) {
  try {
    return read_picture_time(topic, bytes);
  } catch (const BadMessage&) {
    return std::nullopt;  // it is a frame that cannot be read
  }
}

class BagSource : public SkippableSource {
 public:
  BagSource(const std::string& input, const SourceOptions& options)
      : input_(input),
        rate_hz_(options.rate_hz),
        log_(options.log),
        scaling_(input, options),
        bag_(open_bag(input, options.log)),
        topic_index_(choose_image_topic(*bag_, input, options.topic)),
        topic_(bag_->topics()[topic_index_]),
        messages_(*bag_, [this](std::string_view bytes) { return read_stamp(topic_, bytes); }) {
    bag_->choose({topic_index_});
    num_messages_ = bag_->num_messages();
    warn_of_damage();
    pending_ = messages_.next();
    if (!pending_)
      throw io_error(input, fmt::format("topic {} has no message that can be read", topic_.name));
    check_times();
    check_pictures();
  }

  std::optional<SourceFrame> next() override {
    auto message = pending_ ? std::exchange(pending_, std::nullopt) : messages_.next();
    if (!message) {
      warn_of_damage();
      return std::nullopt;
    }
    SourceFrame frame;
    frame.name = fmt::format("{} {} message {}", input_, topic_.name, num_passed_);
    frame.error = message->error;
    if (frame.error.empty()) read(message->bytes(), frame);
    set_time(*message, frame);
    ++num_passed_;
    return frame;
  }

  bool pass_over() override {
    if (!std::exchange(pending_, std::nullopt) && !messages_.pass_over()) {
      warn_of_damage();
      return false;
    }
    ++num_passed_;
    return true;
  }

  std::optional<std::size_t> num_frames() const override { return num_messages_; }
  std::optional<ValueRange> value_range() const override { return scaling_.range(); }
  std::string name() const override { return input_; }

 private:
  // What is wrong with all messages is said before the work.

  void check_times() {
    std::size_t num_with = pending_->has_time(), num_stamps = pending_->stamp.has_value();
    for (const StampedMessage& message : messages_.look_ahead(*pending_)) {
      num_with += message.has_time();
      num_stamps += message.stamp.has_value();
    }
    has_times_ = num_with > 0 || num_stamps == 0;
    if (has_times_ && rate_hz_)
      log_(LogLevel::kWarning, fmt::format("{}: --rate is not used, for its messages carry times", input_));
    if (!has_times_ && !rate_hz_)
      throw invalid_input(input_,
                          fmt::format("topic {}: its messages carry no times (header.stamp is 0): give the "
                                      "frame rate with --rate HZ",
                                      topic_.name));
  }

  /// One bad picture, as many cameras begin with, is a frame that cannot be read.
  void check_pictures() {
    const auto fault = fault_of_picture(*pending_);
    if (!fault) return;
    for (const StampedMessage& message : messages_.look_ahead(*pending_))
      if (!fault_of_picture(message)) return;
    throw invalid_input(input_, fmt::format("topic {}: {}", topic_.name, *fault));
  }

  /// nullopt also of a message that is damaged as a whole: that says nothing of others.
  std::optional<std::string> fault_of_picture(const StampedMessage& message) const {
    if (!message.error.empty() || !read_stamp(topic_, message.bytes())) return std::nullopt;
    try {
      read_picture_message(topic_, message.bytes());
    } catch (const BadMessage& bad) {
      return bad.what();
    }
    return std::nullopt;
  }

  void read(std::string_view bytes, SourceFrame& frame) {
    try {
      const PictureMessage picture = read_picture_message(topic_, bytes);
      frame.pixels = scaling_.to_gray(picture.values, frame.name, [&] { return count_sample(); });
    } catch (const BadMessage& bad) {
      frame.error = bad.what();
    }
  }

  void set_time(StampedMessage& message, SourceFrame& frame) {
    const auto told = has_times_ ? believed_time(message, frame)
                                 : advance({}, static_cast<double>(num_passed_) / *rate_hz_);
    is_first_ = false;
    const std::string time_error = clock_.take(told);
    if (time_error.empty() && told == message.stamp) course_.believe(message);
    if (frame.error.empty()) frame.error = time_error;
    if (!frame.error.empty()) frame.pixels = GrayImage();
    frame.timestamp = clock_.time();
  }

  /// nullopt: just after the frame before.
  std::optional<Timestamp> believed_time(StampedMessage& message, SourceFrame& frame) {
    std::string fault = message.has_time() ? "" : "it carries no time (header.stamp is 0)";
    if (message.has_time() && course_.jumps_ahead(message) &&
        StampCourse::is_wrong(*message.stamp, messages_.look_ahead(message)))
      fault = fmt::format("its time, {} s, is not before those of the frames after it",
                          format_seconds(*message.stamp));
    if (fault.empty()) return message.stamp;
    if (frame.error.empty()) frame.error = fault;
    if (!is_first_) return std::nullopt;
    return StampCourse::first_time(message, messages_.look_ahead(message));
  }

  ValueCounts count_sample() const {
    ValueCounts counts;
    const auto bag = open_bag(input_);
    bag->choose({topic_index_});
    const std::size_t size = std::min(PictureScaling::kMostInSample, bag->num_messages());
    std::size_t position = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t place = PictureScaling::place_in_sample(i, size, num_messages_);
      for (; position < place; ++position) bag->pass_over();
      const auto message = bag->next();
      ++position;
      if (!message || !message->error.empty()) continue;
      try {
        const PictureMessage picture = read_picture_message(topic_, message->bytes);
        if (picture.values.is_deep()) counts.add(picture.values.pixels);
      } catch (const BadMessage&) {
        continue;  // it will be told of when its turn comes
      }
    }
    return counts;
  }

  void warn_of_damage() {
    const std::string damage = bag_->damage();
    if (damage.empty() || damage == reported_damage_) return;
    reported_damage_ = damage;
    log_(LogLevel::kWarning, fmt::format("{}: the bag is cut off or damaged: {}", input_, damage));
  }

  std::string input_;
  std::optional<double> rate_hz_;
  LogSink log_;
  PictureScaling scaling_;
  std::unique_ptr<BagReader> bag_;
  std::size_t topic_index_;
  BagTopic topic_;
  std::size_t num_messages_ = 0;
  StampedMessages messages_;
  StampCourse course_;
  std::optional<StampedMessage> pending_;
  bool has_times_ = true;
  std::size_t num_passed_ = 0;
  bool is_first_ = true;
  ForwardClock clock_;
  std::string reported_damage_;
};

}  // namespace

bool is_bag_input(const std::string& input) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (is_pipe_input(input)) return false;  // it gives its bytes once
  if (!fs::is_directory(input, ignored)) return is_bag(input);
  // Beside another kind of recording, or pictures, a bag is no more than a file there.
  const fs::path folder = input;
  const bool has_recording = is_sequence_folder(folder) || fs::exists(folder / "mav0", ignored) ||
                             fs::exists(folder / "data.csv", ignored);
  if (has_recording || !is_bag(folder)) return false;
  return fs::exists(folder / "metadata.yaml", ignored) || list_images(folder).empty();
}

std::vector<BagImageTopic> bag_image_topics(const std::string& input) {
  const auto bag = open_bag(input);
  std::vector<BagImageTopic> topics;
  for (const std::size_t i : image_topics(*bag))
    topics.push_back({bag->topics()[i].name, bag->topics()[i].type, bag->topics()[i].count});
  return topics;
}

std::unique_ptr<SkippableSource> open_bag_source(const std::string& input, const SourceOptions& options) {
  return std::make_unique<BagSource>(input, options);
}

}  // namespace apriltrack
