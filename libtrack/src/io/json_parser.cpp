#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "yaml_tree.h"

namespace apriltrack {
namespace {

using Json = nlohmann::json;

/// Counts lines while the parser reads; its events tell no place.
class LineCounter {
 public:
  void take(char c) {
    // A number is known to end only at the character after it, so the newest newline does not count yet.
    num_newlines_ += last_ == '\n' ? 1 : 0;
    last_ = c;
  }
  std::size_t line() const { return num_newlines_ + 1; }

 private:
  std::size_t num_newlines_ = 0;
  char last_ = ' ';
};

class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, LineCounter* counter) : at_(at), counter_(counter) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    counter_->take(*at_++);
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  LineCounter* counter_;
};

/// nlohmann's SAX interface; its names are fixed.
class TreeSax {
 public:
  TreeSax(YamlTreeBuilder& builder, const LineCounter& counter) : builder_(builder), counter_(counter) {}

  bool null() { return builder_.null(counter_.line()), true; }
  bool boolean(bool value) { return scalar(value ? "true" : "false", false); }
  bool number_integer(Json::number_integer_t value) { return scalar(std::to_string(value), false); }
  bool number_unsigned(Json::number_unsigned_t value) { return scalar(std::to_string(value), false); }
  bool number_float(Json::number_float_t value, const Json::string_t&) {
    return scalar(format_exact(value), false);
  }
  bool string(Json::string_t& value) { return scalar(value, true); }
  bool binary(Json::binary_t&) { return false; }
  bool start_object(std::size_t) { return builder_.begin_map(counter_.line()), true; }
  bool key(Json::string_t& value) { return scalar(value, true); }
  bool end_object() { return builder_.end(), true; }
  bool start_array(std::size_t) { return builder_.begin_list(counter_.line()), true; }
  bool end_array() { return builder_.end(), true; }
  bool parse_error(std::size_t, const std::string&, const Json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 3, column 5: ..." names its class first.
    const std::string_view text = error.what();
    const std::size_t end_of_class = text.find("] ");
    builder_.fail(counter_.line(), {},
                  fmt::format("is no valid JSON: {}",
                              end_of_class == std::string_view::npos ? text : text.substr(end_of_class + 2)));
  }

 private:
  bool scalar(std::string value, bool is_quoted) {
    return builder_.scalar(counter_.line(), std::move(value), is_quoted), true;
  }

  YamlTreeBuilder& builder_;
  const LineCounter& counter_;
};

}  // namespace

std::shared_ptr<const YamlTreeNode> parse_json(const std::string& text, const std::string& name) {
  LineCounter counter;
  YamlTreeBuilder builder(name);
  builder.refuse_too_many_values(text);
  TreeSax sax(builder, counter);
  Json::sax_parse(CountingIterator(text.data(), &counter),
                  CountingIterator(text.data() + text.size(), &counter), &sax);
  return builder.finish();
}

}  // namespace apriltrack
