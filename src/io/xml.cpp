// Source: W3C, "Extensible Markup Language (XML) 1.0 (Fifth Edition)", 2008; numbers in brackets are its productions.
#include "io/xml.h"

#include "io/xml_text.h"

#include <algorithm>
#include <utility>

namespace g3r::io {

namespace {

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::string_view kNameEnds = " \t\r\n=/<>\"'&";  // none of these is part of a name

class Parser {
 public:
  Parser(std::string_view xml, XmlEvents& events) : xml_(xml), events_(events) {}

  void run() {
    if (const std::size_t bad = first_bad_character(xml_); bad != std::string_view::npos) throw XmlError("not UTF-8", bad);
    while (i_ < xml_.size()) {
      if (xml_[i_] != '<') {
        text();
      } else if (take("<!--")) {
        upto("-->");
      } else if (take("<![CDATA[")) {
        if (open_.empty()) fail("text outside of the elements");
        events_.text(in_unix_lines(upto("]]>")));
      } else if (take("<?")) {
        upto("?>");
      } else if (take("<!")) {
        fail("a document type");
      } else if (take("</")) {
        close();
      } else {
        open();
      }
    }
    if (!open_.empty() || !done_) fail("truncated");
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw XmlError(what, i_); }

  bool take(std::string_view word) {
    if (!xml_.substr(i_).starts_with(word)) return false;
    i_ += word.size();
    return true;
  }

  // What lies before the next `end`, which is passed over.
  std::string_view upto(std::string_view end) {
    const std::size_t found = xml_.find(end, i_);
    if (found == std::string_view::npos) fail("truncated: no \"" + std::string(end) + "\"");
    const std::string_view between = xml_.substr(i_, found - i_);
    i_ = found + end.size();
    return between;
  }

  bool skip_blanks() {
    const std::size_t before = i_;
    i_ = std::min(xml_.find_first_not_of(kBlanks, i_), xml_.size());
    return i_ > before;
  }

  // [5], but for the characters beyond those that end one or may not begin one
  std::string name() {
    const std::size_t end = std::min(xml_.find_first_of(kNameEnds, i_), xml_.size());
    const std::string_view word = xml_.substr(i_, end - i_);
    if (word.empty() || std::string_view("-.0123456789").find(word.front()) != std::string_view::npos) fail("expected a name");
    i_ = end;
    return std::string(word);
  }

  // An opening tag [40, 44] after its '<'.
  void open() {
    ++i_;
    if (done_) fail("more than one element that holds the others");
    const std::string element = name();
    std::vector<XmlAttribute> attributes;
    for (bool blank = skip_blanks();; blank = skip_blanks()) {
      if (take(">")) {
        events_.begin(element, attributes);
        open_.push_back(element);
        return;
      }
      if (take("/>")) {
        events_.begin(element, attributes);
        events_.end(element);
        done_ = open_.empty();
        return;
      }
      if (!blank) fail("expected a blank or the end of the tag");
      attributes.push_back(attribute());
      const auto same = [&](const XmlAttribute& other) { return other.name == attributes.back().name; };
      if (std::find_if(attributes.begin(), attributes.end() - 1, same) != attributes.end() - 1) fail("the same attribute twice");
    }
  }

  XmlAttribute attribute() {  // [41]
    XmlAttribute out{name(), {}};
    skip_blanks();
    if (!take("=")) fail("expected =");
    skip_blanks();
    const std::string_view quote = xml_.substr(i_, 1);
    if (quote != "\"" && quote != "'") fail("expected a quote");
    ++i_;
    std::string value = in_unix_lines(upto(quote));
    if (value.find('<') != std::string::npos) fail("'<' in an attribute");
    std::replace_if(
        value.begin(), value.end(), [](char c) { return c == '\n' || c == '\t'; }, ' ');  // 3.3.3
    out.value = decoded(value, i_);
    return out;
  }

  void close() {
    if (open_.empty() || name() != open_.back()) fail("an end tag without its begin");
    skip_blanks();
    if (!take(">")) fail("expected >");
    const std::string element = std::move(open_.back());
    open_.pop_back();
    events_.end(element);
    done_ = open_.empty();
  }

  void text() {
    const std::size_t end = std::min(xml_.find('<', i_), xml_.size());
    const std::string_view piece = xml_.substr(i_, end - i_);
    if (piece.find("]]>") != std::string_view::npos) fail("\"]]>\" in a text");
    if (!open_.empty()) {
      events_.text(decoded(in_unix_lines(piece), i_));
    } else if (piece.find_first_not_of(kBlanks) != std::string_view::npos) {
      fail("text outside of the elements");
    }
    i_ = end;
  }

  std::string_view xml_;
  XmlEvents& events_;
  std::size_t i_ = 0;
  std::vector<std::string> open_;
  bool done_ = false;  // the element that holds the others has ended
};

}  // namespace

void parse_xml(std::string_view xml, XmlEvents& events) { Parser(xml, events).run(); }

}  // namespace g3r::io
