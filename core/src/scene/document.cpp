#include "scene/document.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "scene/tree.hpp"

namespace pileus::scene {
namespace {

// A scene is some hundred values; more than this is a mistake or an attack by nested aliases.
constexpr std::size_t max_nodes = 200000;
constexpr std::size_t max_depth = 64;

/// Stops the parser after a problem that makes everything behind it meaningless.
struct Abandon {};

/// Builds the tree from yaml-cpp's events. yaml-cpp's own nodes would lose the places of aliases
/// and of duplicate keys, and would follow self-references for ever.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(std::string file, const std::vector<std::string>& lines, Problems& problems)
      : file_(std::move(file)), lines_(lines), problems_(problems) {}

  Node take() { return std::move(root_); }
  bool has_content() const { return seen_; }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnAnchor(const YAML::Mark&, const std::string&) override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Node node;
    node.where = place(mark);
    finish(std::move(node), anchor);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    check_tag(mark, tag);
    Node node;
    node.kind = Node::Kind::scalar;
    node.text = value;
    node.quoted = tag == "!";
    node.where = place(mark);
    finish(std::move(node), anchor);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto target = anchors_.find(anchor);
    if (target == anchors_.end())
      abandon(mark, "this alias refers to the value it is itself a part of");
    Node copy = target->second;
    relocate(copy, place(mark));
    finish(std::move(copy), 0);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(mark, Node::Kind::list, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(mark, Node::Kind::mapping, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    Node node;
    YAML::anchor_t anchor;
    bool awaiting_value = false;
    bool discard = false;  // the value of a key that was refused
    std::string key;
    Location key_where;
  };

  Location place(const YAML::Mark& mark) const {
    return place_of(file_, lines_, mark.line, mark.column);
  }

  [[noreturn]] void abandon(const YAML::Mark& mark, const std::string& text) {
    problems_.add(place(mark), text);
    throw Abandon{};
  }

  void check_tag(const YAML::Mark& mark, const std::string& tag) {
    if (!tag.empty() && tag != "?" && tag != "!")
      problems_.add(place(mark), fmt::format("YAML tags such as '{}' are not used in scenes; write "
                                             "the value alone",
                                             tag));
  }

  void open(const YAML::Mark& mark, Node::Kind kind, YAML::anchor_t anchor) {
    if (levels_.size() >= max_depth)
      abandon(mark, fmt::format("nested more than {} levels deep", max_depth));
    Level level;
    level.node.kind = kind;
    level.node.where = place(mark);
    level.anchor = anchor;
    levels_.push_back(std::move(level));
  }

  void close() {
    Node node = std::move(levels_.back().node);
    const YAML::anchor_t anchor = levels_.back().anchor;
    levels_.pop_back();
    finish(std::move(node), anchor);
  }

  void finish(Node node, YAML::anchor_t anchor) {
    count_ += count_nodes(node);
    if (count_ > max_nodes) {
      problems_.add(node.where, fmt::format("more than {} values; aliases multiply", max_nodes));
      throw Abandon{};
    }
    if (anchor != 0) anchors_[anchor] = node;
    seen_ = true;
    if (levels_.empty()) {
      root_ = std::move(node);
      return;
    }
    Level& parent = levels_.back();
    if (parent.node.kind == Node::Kind::list)
      parent.node.items.push_back(std::move(node));
    else if (!parent.awaiting_value)
      accept_key(parent, node);
    else {
      parent.awaiting_value = false;
      if (!parent.discard)
        parent.node.entries.push_back({parent.key, parent.key_where, std::move(node)});
    }
  }

  void accept_key(Level& parent, const Node& node) {
    parent.awaiting_value = true;
    parent.discard = false;
    parent.key = node.text;
    parent.key_where = node.where;
    if (node.kind != Node::Kind::scalar) {
      problems_.add(node.where, "a key must be a word");
      parent.discard = true;
    } else if (node.text == "<<" && !node.quoted) {
      problems_.add(node.where,
                    "merge keys ('<<') are not supported; write the keys out, or put what is "
                    "shared into another scene and name it in 'extends'",
                    2);
      parent.discard = true;
    } else if (const Entry* first = parent.node.find(node.text)) {
      problems_.add({node.where, fmt::format("the key '{}' is given twice", node.text),
                     node.width(), first->where, "it was given first here"});
      parent.discard = true;
    }
  }

  std::string file_;
  const std::vector<std::string>& lines_;
  Problems& problems_;
  Node root_;
  bool seen_ = false;
  std::size_t count_ = 0;
  std::vector<Level> levels_;
  std::map<YAML::anchor_t, Node> anchors_;
};

std::vector<std::string> split_lines(std::string_view text) {
  std::vector<std::string> lines;
  std::istringstream stream{std::string(text)};
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Tabs before the first word: YAML forbids them, yaml-cpp accepts some and misreads others.
bool report_tabs(const std::string& file, const std::vector<std::string>& lines,
                 Problems& problems) {
  bool found = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t word = lines[i].find_first_not_of(" \t\r");
    if (word == std::string::npos || lines[i][word] == '#') continue;
    const std::size_t tab = lines[i].find('\t');
    if (tab >= word) continue;
    problems.add({file, static_cast<int>(i + 1), static_cast<int>(tab + 1)},
                 "a tab cannot indent YAML; use spaces");
    found = true;
  }
  return found;
}

/// yaml-cpp's words for the commonest slips, in the words of someone who wrote the file.
std::string explain_syntax(const std::string& message) {
  if (message == "illegal map value")
    return "this ':' starts a second mapping on the line; put text that contains ': ' in quotes, "
           "or "
           "begin a new line";
  if (message == "end of map not found" || message == "end of map flow not found")
    return "the mapping that begins here is not closed, or a line below it is indented wrongly";
  if (message == "end of sequence not found" || message == "end of sequence flow not found")
    return "the list that begins here is not closed, or a line below it is indented wrongly";
  if (message == "illegal flow end")
    return "this bracket does not close the one that was opened last";
  if (message == "the referenced anchor is not defined")
    return "this alias refers to an anchor that is not defined above";
  return message;
}

}  // namespace

Node parse_document(const std::string& file, std::string_view text, Problems& problems) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  problems.remember_source(file, text);
  const std::vector<std::string> lines = split_lines(text);
  if (const std::size_t bad = find_not_utf8(text); bad != std::string_view::npos) {
    const auto line =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(bad), '\n');
    problems.add({file, static_cast<int>(line + 1), 1},
                 "this is not UTF-8 text; save the scene as UTF-8");
    return {};
  }
  if (report_tabs(file, lines, problems)) return {};

  std::istringstream stream{std::string(text)};
  TreeBuilder builder(file, lines, problems);
  try {
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    TreeBuilder extra(file, lines, problems);
    Node first = builder.take();
    if (parser.HandleNextDocument(extra) && extra.has_content())
      problems.add(extra.take().where,
                   "a second document begins here (after '---'); a scene is one document");
    return first;
  } catch (const Abandon&) {
    return {};
  } catch (const YAML::Exception& failure) {
    problems.add(place_of(file, lines, failure.mark.line, failure.mark.column),
                 "not valid YAML: " + explain_syntax(failure.msg));
    return {};
  }
}

}  // namespace pileus::scene
