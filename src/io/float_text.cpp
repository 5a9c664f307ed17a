#include "io/float_text.h"

namespace g3r::io {

std::from_chars_result number_from_chars(const char* first, const char* last, double& value) { return std::from_chars(first, last, value); }
std::to_chars_result number_to_chars(char* first, char* last, double value) { return std::to_chars(first, last, value); }
std::to_chars_result number_to_chars(char* first, char* last, float value) { return std::to_chars(first, last, value); }

}  // namespace g3r::io
