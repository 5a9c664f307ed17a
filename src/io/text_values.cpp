#include "io/text_values.h"

#include "io/text_numbers.h"

namespace g3r::io {

namespace {

// Where a quoted value at the start of the text ends, 0 if there is none.
std::size_t quoted_length(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos || text[begin] != '"') return 0;
  for (std::size_t at = begin + 1; (at = text.find('"', at)) != std::string_view::npos; at += 2) {
    if (at + 1 == text.size() || text[at + 1] != '"') return at + 1;
  }
  return 0;
}

// Whether a separator, one of ',' and ';', stands in the line and not within a quoted value.
bool has_separator(std::string_view line, char wanted) {
  for (std::size_t at = 0; at < line.size(); ++at) {
    at = line.find_first_of(",;", at + quoted_length(line.substr(at)));
    if (at == std::string_view::npos) return false;
    if (line[at] == wanted) return true;
  }
  return false;
}

bool is_number(std::string_view value) {
  double number = 0;
  return parse_double(value, number);
}

// Several numbers between two separators, as "5 0" where commas are decimal ones.
bool are_numbers(std::string_view field) {
  Tokens parts(field);
  std::string_view part;
  std::size_t count = 0;
  for (; parts.next(part); ++count) {
    if (!is_number(part)) return false;
  }
  return count > 1;
}

// Whether tabs separate the values: at least three numbers stand between single ones, and no two numbers with a blank between them.
bool has_tabs(std::string_view line) {
  if (line.find('\t') == std::string_view::npos || line.find("\t\t") != std::string_view::npos) return false;
  Values fields(line, '\t');
  std::string_view field;
  std::size_t numbers = 0;
  while (fields.next(field)) {
    if (are_numbers(field)) return false;
    numbers += is_number(field) ? 1 : 0;
  }
  return numbers >= 3;
}

}  // namespace

char separator_of(std::string_view line) {
  if (has_tabs(line)) return '\t';
  if (has_separator(line, ';')) return ';';
  if (!has_separator(line, ',')) return ' ';
  Values fields(line, ',');
  std::string_view field;
  while (fields.next(field)) {
    if (are_numbers(field)) return ' ';
  }
  return ',';
}

Values::Values(std::string_view line, char separator) : blanks_(line), rest_(line), separator_(separator), more_(!line.empty()) {
  if (separator != ' ' && more_ && line.back() == separator) rest_.remove_suffix(1);
}

bool Values::next(std::string_view& value) {
  if (separator_ == ' ') return blanks_.next(value);
  if (!more_) return false;
  const std::size_t end = rest_.find(separator_, quoted_length(rest_));
  value = trim(rest_.substr(0, end));
  if (value.size() > 1 && value.front() == '"' && value.back() == '"') value = trim(value.substr(1, value.size() - 2));
  more_ = end != std::string_view::npos;
  if (more_) rest_.remove_prefix(end + 1);
  return true;
}

bool is_missing(std::string_view value) {
  if (value.empty()) return true;
  const std::string word = value.size() <= 4 ? lower_case(value) : "";
  return word == "na" || word == "n/a" || word == "null" || word == "none";
}

bool ends_with_separator(std::string_view line, char separator) { return separator != ' ' && !line.empty() && line.back() == separator; }

std::size_t count_values(std::string_view line, char separator) {
  Values values(line, separator);
  std::string_view value;
  std::size_t count = 0;
  while (values.next(value)) ++count;
  return count;
}

std::size_t count_numbers(std::string_view line, char separator) {
  Values values(line, separator);
  std::string_view value;
  std::size_t count = 0;
  while (values.next(value)) count += is_number(value) ? 1 : 0;
  return count;
}

bool is_like_number(std::string_view value) { return value.find_first_of("+-.0123456789") == 0; }

}  // namespace g3r::io
