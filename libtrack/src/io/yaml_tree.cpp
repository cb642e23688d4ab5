#include "yaml_tree.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

using Kind = YamlTreeNode::Kind;

std::string child_path(const std::string& parent, const std::string& key) {
  return parent.empty() ? key : parent + "." + key;
}

}  // namespace

YamlTreeBuilder::YamlTreeBuilder(const std::string& file)
    : file_(std::make_shared<const std::string>(file)) {}

void YamlTreeBuilder::fail(std::size_t line, const std::string& path, const std::string& what) const {
  throw invalid_input(fmt::format("{}:{}", *file_, line), path.empty() ? what : path + ": " + what);
}

void YamlTreeBuilder::fail_of_too_many_values(std::size_t line) const {
  fail(line, {}, fmt::format("has more than {} values, which no file of this kind needs", kMaxNodes));
}

void YamlTreeBuilder::refuse_too_many_values(std::string_view text) const {
  const auto num_parted = std::ranges::count_if(text, [](char c) { return c == ',' || c == '\n'; });
  if (static_cast<std::size_t>(num_parted) > kMaxNodes) fail_of_too_many_values(1);
}

bool YamlTreeBuilder::expects_key() const {
  return !open_.empty() && open_.back().node->kind == Kind::kMap && !open_.back().has_pending_key;
}

void YamlTreeBuilder::take_key(std::size_t line, std::string key) {
  Level& level = open_.back();
  const auto first = level.node->index.find(key);
  if (first != level.node->index.end()) {
    fail(line, child_path(level.node->path, key),
         fmt::format("this key stands twice in the same mapping (first in line {}); keep one of them",
                     level.node->key_lines[first->second]));
  }
  level.pending_key = std::move(key);
  level.pending_line = line;
  level.has_pending_key = true;
}

std::string YamlTreeBuilder::next_path() const {
  if (open_.empty()) return {};
  const Level& level = open_.back();
  if (level.node->kind == Kind::kMap) return child_path(level.node->path, level.pending_key);
  return fmt::format("{}[{}]", level.node->path, level.node->children.size());
}

std::shared_ptr<YamlTreeNode> YamlTreeBuilder::make(Kind kind, std::size_t line) {
  if (++num_nodes_ > kMaxNodes) fail_of_too_many_values(line);
  auto node = std::make_shared<YamlTreeNode>();
  node->kind = kind;
  node->file = file_;
  const bool follows_key = !open_.empty() && open_.back().has_pending_key;
  node->line = follows_key && kind != Kind::kScalar ? open_.back().pending_line : line;
  node->path = next_path();
  return node;
}

void YamlTreeBuilder::add(std::shared_ptr<const YamlTreeNode> node) {
  if (open_.empty()) {
    root_ = std::move(node);
    return;
  }
  Level& level = open_.back();
  if (level.node->kind == Kind::kMap) {
    level.node->index.emplace(level.pending_key, level.node->keys.size());
    level.node->keys.push_back(std::move(level.pending_key));
    level.node->key_lines.push_back(level.pending_line);
    level.has_pending_key = false;
  }
  level.node->num_nodes += node->num_nodes;
  level.node->children.push_back(std::move(node));
}

std::shared_ptr<const YamlTreeNode> YamlTreeBuilder::null(std::size_t line) {
  if (expects_key()) fail(line, open_.back().node->path, "a key is missing before ':'");
  auto node = make(Kind::kNull, line);
  add(node);
  return node;
}

std::shared_ptr<const YamlTreeNode> YamlTreeBuilder::scalar(std::size_t line, std::string value,
                                                            bool is_quoted, std::string tag) {
  if (expects_key()) {
    take_key(line, std::move(value));
    return nullptr;
  }
  auto node = make(Kind::kScalar, line);
  node->scalar = std::move(value);
  node->is_quoted = is_quoted;
  node->tag = std::move(tag);
  add(node);
  return node;
}

void YamlTreeBuilder::begin(Kind kind, std::size_t line, std::string tag) {
  if (expects_key())
    fail(line, open_.back().node->path, "a key must be a plain word or number, no list or mapping");
  if (open_.size() == kMaxDepth) fail(line, {}, fmt::format("nested more than {} deep", kMaxDepth));
  Level level;
  level.node = make(kind, line);
  level.node->tag = std::move(tag);
  open_.push_back(std::move(level));
}

void YamlTreeBuilder::begin_list(std::size_t line, std::string tag) {
  begin(Kind::kList, line, std::move(tag));
}

void YamlTreeBuilder::begin_map(std::size_t line, std::string tag) {
  begin(Kind::kMap, line, std::move(tag));
}

std::shared_ptr<const YamlTreeNode> YamlTreeBuilder::end() {
  std::shared_ptr<const YamlTreeNode> node = std::move(open_.back().node);
  open_.pop_back();
  add(node);
  return node;
}

void YamlTreeBuilder::repeat(std::size_t line, const std::shared_ptr<const YamlTreeNode>& node) {
  if (expects_key())
    fail(line, open_.back().node->path, "an alias cannot stand for a key; write the key out");
  num_repeated_nodes_ += node->num_nodes;
  if (num_repeated_nodes_ > kMaxRepeatedNodes) {
    fail(line, next_path(),
         fmt::format("the aliases of this file stand for more than {} values; write them out",
                     kMaxRepeatedNodes));
  }
  add(node);
}

std::shared_ptr<const YamlTreeNode> YamlTreeBuilder::finish() {
  if (!root_) root_ = make(Kind::kNull, 1);
  return root_;
}

}  // namespace apriltrack
