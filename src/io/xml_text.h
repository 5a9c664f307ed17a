// The characters of a document in XML: which are allowed, and what ends of lines and references stand for.
// Source: W3C, "Extensible Markup Language (XML) 1.0 (Fifth Edition)", 2008; numbers in brackets are its productions.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace g3r::io {

/// The place of the first byte that does not belong to a character in UTF-8 that XML allows [2]; npos if there is none.
std::size_t first_bad_character(std::string_view text);

/// The text with LF for every CR LF and CR (section 2.11).
std::string in_unix_lines(std::string_view piece);

/// The text with characters for references [66, 68]: "&#38;", "&#x26;" and the five entities that need no declaration. Throws XmlError with
/// the offset `at` for others.
std::string decoded(const std::string& piece, std::size_t at);

}  // namespace g3r::io
