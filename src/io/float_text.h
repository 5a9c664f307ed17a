// Floating point numbers as text: std::from_chars and std::to_chars where the standard library has them, else the same from C's functions.
#pragma once

#include <charconv>

namespace g3r::io {

/// As std::from_chars(first, last, value): the longest number from `first` on, whatever the locale.
std::from_chars_result number_from_chars(const char* first, const char* last, double& value);

/// As std::to_chars(first, last, value): the shortest text that reads back as the same number. 32 characters always suffice.
std::to_chars_result number_to_chars(char* first, char* last, double value);
std::to_chars_result number_to_chars(char* first, char* last, float value);

}  // namespace g3r::io
