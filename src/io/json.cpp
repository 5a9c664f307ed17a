#include "io/json.h"

#include "io/text_numbers.h"

#include <cmath>

namespace g3r::io {

namespace {

constexpr int kDeepest = 64;  // Deeper nesting would use up the stack; descriptions of clouds and glTF need about ten.

class Parser {
 public:
  Parser(std::string_view text, std::size_t most_values) : rest_(text), left_(most_values) {}

  std::optional<Json> parse() {
    Json root;
    if (!value(root, 0)) return std::nullopt;
    skip();
    if (!rest_.empty()) return std::nullopt;
    return root;
  }

 private:
  bool value(Json& json, int depth) {
    if (depth > kDeepest || left_ == 0) return false;
    --left_;
    skip();
    if (rest_.empty()) return false;
    switch (rest_.front()) {
      case '{':
        return object(json, depth);
      case '[':
        return array(json, depth);
      case '"':
        json.kind = Json::Kind::kString;
        return string(json.text);
      default:
        return word(json);
    }
  }

  bool object(Json& json, int depth) {
    json.kind = Json::Kind::kObject;
    rest_.remove_prefix(1);
    if (take('}')) return true;
    do {
      skip();
      std::string_view key;
      if (!string(key) || !take(':')) return false;
      json.keys.push_back(key);
      json.items.emplace_back();
      if (!value(json.items.back(), depth + 1)) return false;
    } while (take(','));
    return take('}');
  }

  bool array(Json& json, int depth) {
    json.kind = Json::Kind::kArray;
    rest_.remove_prefix(1);
    if (take(']')) return true;
    do {
      json.items.emplace_back();
      if (!value(json.items.back(), depth + 1)) return false;
    } while (take(','));
    return take(']');
  }

  bool string(std::string_view& text) {
    if (rest_.empty() || rest_.front() != '"') return false;
    for (std::size_t end = 1; end < rest_.size(); ++end) {
      if (rest_[end] == '\\') {
        ++end;
      } else if (rest_[end] == '"') {
        text = rest_.substr(1, end - 1);
        rest_.remove_prefix(end + 1);
        return true;
      }
    }
    return false;
  }

  bool word(Json& json) {
    const std::size_t end = std::min(rest_.find_first_of(",]} \t\r\n"), rest_.size());
    json.text = rest_.substr(0, end);
    rest_.remove_prefix(end);
    if (json.text == "true" || json.text == "false") {
      json.kind = Json::Kind::kBool;
      return true;
    }
    if (json.text == "null") return true;
    json.kind = Json::Kind::kNumber;
    return json.text.find_first_of("-0123456789") == 0 && parse_double(json.text, json.number);
  }

  bool take(char c) {
    skip();
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void skip() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size())); }

  std::string_view rest_;
  std::size_t left_;
};

}  // namespace

std::optional<std::uint64_t> Json::whole() const {
  constexpr double kMost = 9007199254740992.0;  // 2^53: above it, a double does not hold every whole number.
  if (kind != Kind::kNumber || !(number >= 0 && number <= kMost) || number != std::floor(number)) return std::nullopt;
  return static_cast<std::uint64_t>(number);
}

const Json* Json::find(std::string_view key) const {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i] == key) return &items[i];
  }
  return nullptr;
}

std::optional<Json> parse_json(std::string_view text, std::size_t most_values) { return Parser(text, most_values).parse(); }

}  // namespace g3r::io
