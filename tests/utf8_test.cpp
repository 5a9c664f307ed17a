#include "io/utf8.h"

#include <gtest/gtest.h>

#include <string>

namespace g3r {
namespace {

bool is_surrogate(unsigned code) { return code >= 0xD800 && code < 0xE000; }

TEST(Utf8, EveryCharacterComesBackButSurrogates) {
  for (unsigned code = 0; code <= 0x10FFFF; ++code) {
    std::string text;
    io::append_utf8(code, text);
    unsigned read = 0;
    ASSERT_EQ(io::utf8_length(text + "x", read), is_surrogate(code) ? 0 : text.size()) << code;
    ASSERT_TRUE(is_surrogate(code) || read == code) << code;
  }
}

TEST(Utf8, WhatIsCutOrSpelledLongerIsNoCharacter) {
  unsigned code = 0;
  for (const char* text : {"", "\x80", "\xc3", "\xe2\x82", "\xf0\x9f\x98", "\xc3(", "\xc1\xbf", "\xe0\x9f\xbf", "\xf0\x8f\xbf\xbf",
                           "\xf4\x90\x80\x80", "\xff"}) {
    EXPECT_EQ(io::utf8_length(text, code), 0U) << text;
  }
}

}  // namespace
}  // namespace g3r
