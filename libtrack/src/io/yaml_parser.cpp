#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "apriltrack/base/error.h"
#include "yaml_tree.h"

namespace apriltrack {
namespace {

/// The parser counts lines from 0.
std::size_t line_of(const YAML::Mark& mark) {
  return mark.is_null() ? 1 : static_cast<std::size_t>(mark.line) + 1;
}

/// "?" and "!" are the parser's signs for plain and quoted scalars without a tag.
std::string application_tag(const std::string& tag) {
  return tag == "?" || tag == "!" ? std::string() : tag;
}

class TreeEvents : public YAML::EventHandler {
 public:
  explicit TreeEvents(YamlTreeBuilder& builder) : builder_(builder) {}

  void OnDocumentStart(const YAML::Mark& mark) override { start_ = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    remember(anchor, builder_.null(line_of(mark)));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    // A node that holds an alias of itself is not finished, hence not yet remembered.
    if (found == anchors_.end())
      builder_.fail(line_of(mark), {}, "an alias stands inside what it stands for");
    builder_.repeat(line_of(mark), found->second);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    const auto node = builder_.scalar(line_of(mark), value, tag == "!", application_tag(tag));
    if (anchor != 0 && !node)
      builder_.fail(
          line_of(mark), {},
          fmt::format("an anchor cannot stand before a key ('{}'); write it before the value", value));
    remember(anchor, node);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    builder_.begin_list(line_of(mark), application_tag(tag));
    open_anchors_.push_back(anchor);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    builder_.begin_map(line_of(mark), application_tag(tag));
    open_anchors_.push_back(anchor);
  }
  void OnMapEnd() override { end(); }

  /// Where the document begins.
  const YAML::Mark& start() const { return start_; }

 private:
  void end() {
    remember(open_anchors_.back(), builder_.end());
    open_anchors_.pop_back();
  }
  void remember(YAML::anchor_t anchor, const std::shared_ptr<const YamlTreeNode>& node) {
    if (anchor != 0) anchors_[anchor] = node;
  }

  YamlTreeBuilder& builder_;
  YAML::Mark start_;
  std::map<YAML::anchor_t, std::shared_ptr<const YamlTreeNode>> anchors_;
  std::vector<YAML::anchor_t> open_anchors_;
};

/// OpenCV opens its files with "%YAML:1.0", which is no directive of YAML; the line stays, as a comment, so
/// that lines keep their numbers.
std::string without_opencv_directive(const std::string& text) {
  if (!text.starts_with("%YAML:")) return text;
  std::string mended = text;
  mended[0] = '#';
  return mended;
}

/// What `ros2 topic echo` writes ends in "---", which begins a document without anything in it: such are
/// passed over. At a comma that stands where none may, the parser (yaml-cpp 0.7) gives documents without end
/// that begin there and have nothing in them.
void refuse_further_documents(YAML::Parser& parser, YAML::Mark last_start, const std::string& name) {
  while (true) {
    YamlTreeBuilder builder(name);
    TreeEvents events(builder);
    if (!parser.HandleNextDocument(events)) return;
    const auto root = builder.finish();
    const YAML::Mark start = std::exchange(last_start, events.start());
    if (start.pos == last_start.pos)
      builder.fail(line_of(start), {},
                   fmt::format("is no valid YAML: a comma stands where none may "
                               "(column {})",
                               start.column + 1));
    if (root->kind == YamlTreeNode::Kind::kNull) continue;
    builder.fail(root->line, {},
                 "a second YAML document begins; a file must hold one (`ros2 topic echo --once` writes one)");
  }
}

std::string_view line_text(std::string_view text, std::size_t line) {
  for (std::size_t i = 1; i < line; ++i) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

std::string explain(const YAML::Exception& error, std::string_view text) {
  const std::string_view line = line_text(text, line_of(error.mark));
  const std::string_view indentation = line.substr(0, line.find_first_not_of(" \t"));
  std::string hint;
  if (indentation.find('\t') != std::string_view::npos) hint = "; a tab indents this line: YAML wants spaces";
  return fmt::format("is no valid YAML: {} (column {}){}", error.msg,
                     error.mark.is_null() ? 1 : error.mark.column + 1, hint);
}

}  // namespace

std::shared_ptr<const YamlTreeNode> parse_yaml(const std::string& text, const std::string& name) {
  YamlTreeBuilder builder(name);
  builder.refuse_too_many_values(text);
  if (text.find('\0') != std::string::npos) builder.fail(1, {}, "is no text file (it holds zero bytes)");
  std::istringstream stream(without_opencv_directive(text));
  TreeEvents events(builder);
  try {
    YAML::Parser parser(stream);
    parser.HandleNextDocument(events);
    refuse_further_documents(parser, events.start(), name);
    return builder.finish();
  } catch (const YAML::Exception& error) {
    builder.fail(line_of(error.mark), {}, explain(error, text));
  }
}

}  // namespace apriltrack
