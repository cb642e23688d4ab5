#include "sqlite_bag.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "apriltrack/base/error.h"
#include "sqlite_database.h"
#include "unpack.h"

namespace apriltrack {
namespace {

using Step = SqliteDatabase::Statement::Step;

class SqliteBag : public BagReader {
 public:
  SqliteBag(const std::filesystem::path& path, const std::string& name)
      : database_(path, name), blob_((check_tables(), database_), "SELECT data FROM messages WHERE id = ?") {
    read_topics();
    list_all_rows();
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }

  void choose(const std::set<std::size_t>& topics) override {
    rows_.clear();
    for (const Row& row : all_rows_)
      if (topics.contains(row.topic)) rows_.push_back(row);
    std::ranges::sort(rows_, {}, [](const Row& row) { return std::tuple(row.time_ns, row.id); });
    position_ = 0;
  }

  std::size_t num_messages() const override { return rows_.size(); }

  std::optional<Timestamp> next_time() override {
    if (position_ >= rows_.size()) return std::nullopt;
    return Timestamp{rows_[position_].time_ns};
  }

  bool pass_over() override {
    if (position_ >= rows_.size()) return false;
    ++position_;
    return true;
  }

  std::optional<BagMessage> next() override {
    if (position_ >= rows_.size()) return std::nullopt;
    const Row& row = rows_[position_++];
    BagMessage message{row.topic, {row.time_ns}, {}, {}};
    blob_.bind(row.id);
    if (blob_.step() == Step::kRow) message.bytes = blob_.blob(0);
    if (message.bytes.empty()) message.error = fmt::format("row {} of its table is damaged", row.id);
    unpack_message(message, unpacked_);
    if (!message.error.empty() && ++num_lost_ == 1) first_lost_ = message.error;
    return message;
  }

  std::string damage() const override {
    std::vector<std::string> parts;
    const SqliteLog& log = database_.log();
    if (log.kind == SqliteLog::Kind::kRollback)
      parts.push_back(
          fmt::format("its recorder did not finish the last transaction ({} lies beside it): "
                      "messages of that may be missing or wrong",
                      log.name));
    if (log.kind == SqliteLog::Kind::kUnreadAhead)
      parts.push_back(fmt::format("what is in {} is missing, for it {}", log.name, log.reason));
    if (is_damaged_)
      parts.push_back(
          fmt::format("the table of messages is damaged: {} rows were found one by one", all_rows_.size()));
    if (num_unknown_ > 0)
      parts.push_back(fmt::format("{} messages are of no topic that it lists", num_unknown_));
    if (num_lost_ > 0)
      parts.push_back(fmt::format("{} message{} cannot be read (the first: {})", num_lost_,
                                  num_lost_ == 1 ? "" : "s", first_lost_));
    return fmt::format("{}", fmt::join(parts, "; "));
  }

 private:
  struct Row {
    std::int64_t id = 0;
    std::int64_t time_ns = 0;
    std::size_t topic = 0;
  };

  void check_tables() const {
    // Throws where not even the list of tables can be read.
    SqliteDatabase::Statement tables(database_, "SELECT name FROM sqlite_master");
    Step step = Step::kRow;
    while (step == Step::kRow) step = tables.step();
    if (step == Step::kDamaged)
      throw io_error(database_.name(), fmt::format("cannot be read: {}", database_.last_error()));
    for (const auto& [table, column] : {std::pair("topics", "id"),
                                        {"topics", "name"},
                                        {"topics", "type"},
                                        {"topics", "serialization_format"},
                                        {"messages", "id"},
                                        {"messages", "topic_id"},
                                        {"messages", "timestamp"},
                                        {"messages", "data"}}) {
      if (database_.has_column(table, column)) continue;
      throw invalid_input(database_.name(),
                          fmt::format("is a SQLite file, but no bag of rosbag2: it has no table "
                                      "'{}' with a column '{}'",
                                      table, column));
    }
  }

  void read_topics() {
    SqliteDatabase::Statement statement(database_, "SELECT id, name, type, serialization_format FROM topics");
    Step step = statement.step();
    for (; step == Step::kRow; step = statement.step()) {
      const BagTopic topic{statement.text(1), statement.text(2), statement.text(3), "", 0};
      const auto same = std::ranges::find_if(topics_, [&](const BagTopic& other) {
        return other.name == topic.name && other.type == topic.type && other.encoding == topic.encoding;
      });
      topic_of_id_[statement.integer(0)] = static_cast<std::size_t>(same - topics_.begin());
      if (same == topics_.end()) topics_.push_back(topic);
    }
    if (step == Step::kDamaged)
      throw io_error(database_.name(), fmt::format("its topics cannot be read: {}", database_.last_error()));
  }

  void list_all_rows() {
    SqliteDatabase::Statement statement(
        database_, "SELECT id, topic_id, timestamp FROM messages NOT INDEXED ORDER BY id");
    Step step = statement.step();
    for (; step == Step::kRow; step = statement.step()) add_row(statement);
    is_damaged_ = step == Step::kDamaged;
    // Between two states of the table a row may stand in both of its pages.
    if (is_damaged_ || database_.log().kind == SqliteLog::Kind::kRollback) search_rows();
    for (const Row& row : all_rows_) ++topics_[row.topic].count;
  }

  void add_row(const SqliteDatabase::Statement& statement) {
    const auto topic = topic_of_id_.find(statement.integer(1));
    if (topic == topic_of_id_.end())
      ++num_unknown_;
    else
      all_rows_.push_back({statement.integer(0), statement.integer(2), topic->second});
  }

  /// Beyond damage, row by row: recorders number them from 1 on without gaps.
  void search_rows() {
    constexpr std::int64_t kLongestGap = 100'000;
    all_rows_.clear();
    num_unknown_ = 0;
    SqliteDatabase::Statement statement(database_,
                                        "SELECT id, topic_id, timestamp FROM messages WHERE id = ?");
    for (std::int64_t id = 1, last = 0; id - last <= kLongestGap; ++id) {
      statement.bind(id);
      if (statement.step() != Step::kRow || statement.integer(0) != id) continue;
      last = id;
      add_row(statement);
    }
  }

  SqliteDatabase database_;
  SqliteDatabase::Statement blob_;
  std::vector<BagTopic> topics_;
  std::map<std::int64_t, std::size_t> topic_of_id_;
  std::vector<Row> all_rows_;
  std::vector<Row> rows_;  ///< Of the topics chosen, in the order of time.
  std::size_t position_ = 0;
  ByteBuffer unpacked_;
  bool is_damaged_ = false;
  std::size_t num_unknown_ = 0;
  std::size_t num_lost_ = 0;
  std::string first_lost_;
};

}  // namespace

std::unique_ptr<BagReader> sqlite_bag(const std::filesystem::path& path, const std::string& name) {
  return std::make_unique<SqliteBag>(path, name);
}

}  // namespace apriltrack
