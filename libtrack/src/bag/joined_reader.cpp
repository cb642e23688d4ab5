#include "joined_reader.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace apriltrack {
namespace {

class JoinedReader : public BagReader {
 public:
  explicit JoinedReader(std::vector<BagPart> parts) : parts_(std::move(parts)) {
    std::map<std::tuple<std::string, std::string, std::string>, std::size_t> known;
    for (const BagPart& part : parts_) {
      std::vector<std::size_t>& of_part = topic_of_part_.emplace_back();
      for (const BagTopic& topic : part.reader->topics()) {
        const auto [place, is_new] = known.insert({{topic.name, topic.type, topic.encoding}, topics_.size()});
        if (is_new) topics_.push_back({topic.name, topic.type, topic.encoding, topic.schema_encoding, 0});
        topics_[place->second].count += topic.count;
        of_part.push_back(place->second);
      }
    }
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }

  void choose(const std::set<std::size_t>& topics) override {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      std::set<std::size_t> of_part;
      for (std::size_t k = 0; k < topic_of_part_[i].size(); ++k)
        if (topics.contains(topic_of_part_[i][k])) of_part.insert(k);
      parts_[i].reader->choose(of_part);
    }
  }

  std::size_t num_messages() const override {
    std::size_t count = 0;
    for (const BagPart& part : parts_) count += part.reader->num_messages();
    return count;
  }

  std::optional<Timestamp> next_time() override {
    const auto part = earliest();
    return part ? parts_[*part].reader->next_time() : std::nullopt;
  }

  bool pass_over() override {
    const auto part = earliest();
    return part && parts_[*part].reader->pass_over();
  }

  std::optional<BagMessage> next() override {
    while (const auto part = earliest()) {
      auto message = parts_[*part].reader->next();
      if (!message) continue;  // it had promised one that is not there
      message->topic = topic_of_part_[*part][message->topic];
      return message;
    }
    return std::nullopt;
  }

  std::string damage() const override {
    std::string text;
    for (const BagPart& part : parts_) {
      const std::string one = part.reader->damage();
      if (!one.empty()) text += (text.empty() ? "" : "; ") + part.name + ": " + one;
    }
    return text;
  }

 private:
  /// The part whose message comes next: the first of those of one time.
  std::optional<std::size_t> earliest() {
    std::optional<std::size_t> first;
    std::optional<Timestamp> time;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const auto of_part = parts_[i].reader->next_time();
      if (!of_part || (time && *of_part >= *time)) continue;
      first = i;
      time = of_part;
    }
    return first;
  }

  std::vector<BagPart> parts_;
  std::vector<std::vector<std::size_t>> topic_of_part_;  ///< Ours, by the part's own.
  std::vector<BagTopic> topics_;
};

}  // namespace

std::unique_ptr<BagReader> joined_reader(std::vector<BagPart> parts) {
  return std::make_unique<JoinedReader>(std::move(parts));
}

}  // namespace apriltrack
