// Numbers as text by C's functions, for standard libraries that lack the conversions: the same as the standard's.
#include "io/float_text.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#define number_from_chars c_number_from_chars
#define number_to_chars c_number_to_chars
#include "io/float_text_c.cpp"  // NOLINT(bugprone-suspicious-include)
#undef number_from_chars
#undef number_to_chars

namespace g3r::io {
namespace {

template <class T>
std::string written_by_c(T value) {
  char text[32];
  const auto [end, error] = c_number_to_chars(text, text + sizeof text, value);
  EXPECT_EQ(error, std::errc());
  return {text, end};
}

template <class T>
std::string written(T value) {
  char text[32];
  return {text, number_to_chars(text, text + sizeof text, value).ptr};
}

void expect_same_reading(std::string_view text) {
  double found = 7, expected = 7;
  const char* end = text.data() + text.size();
  const auto by_c = c_number_from_chars(text.data(), end, found);
  const auto standard = number_from_chars(text.data(), end, expected);
  EXPECT_EQ(by_c.ec, standard.ec) << text;
  EXPECT_EQ(by_c.ptr - text.data(), standard.ptr - text.data()) << text;
  EXPECT_TRUE(std::memcmp(&found, &expected, sizeof found) == 0 || (std::isnan(found) && std::isnan(expected))) << text;
}

// Of any bits, and decimals as people write them.
template <class T, class Bits>
void expect_same_writing() {
  std::mt19937_64 random(1);
  for (int i = 0; i < 30000; ++i) {
    const auto bits = static_cast<Bits>(random());
    T any = 0;
    std::memcpy(&any, &bits, sizeof any);
    const T decimal = static_cast<T>(static_cast<double>(random() % 2000000) / 1000 - 1000);
    const T whole = static_cast<T>(std::ldexp(static_cast<double>(3 + 2 * (random() % 1000)), static_cast<int>(random() % 100)));
    for (const T value : {any, decimal, whole}) {
      if (std::isnan(value)) continue;
      ASSERT_EQ(written_by_c(value), written(value));
      if constexpr (sizeof(T) == sizeof(double)) expect_same_reading(written(value));
    }
  }
}

TEST(FloatText, CWritesDoublesAsTheStandardDoes) { expect_same_writing<double, std::uint64_t>(); }
TEST(FloatText, CWritesFloatsAsTheStandardDoes) { expect_same_writing<float, std::uint32_t>(); }

TEST(FloatText, CWritesExtremesAsTheStandardDoes) {
  using Limits = std::numeric_limits<double>;
  for (const double value :
       {0.0, -0.0, Limits::min(), Limits::denorm_min(), 12345 * Limits::denorm_min(), Limits::max(), Limits::lowest(), Limits::infinity(),
        -Limits::infinity(), 1e15, 1e16, 1e21, 1e22, 1e23, 123456789012345680.0, 9007199254740993.0}) {
    EXPECT_EQ(written_by_c(value), written(value));
  }
  EXPECT_EQ(written_by_c(Limits::quiet_NaN()), "nan");
  char small[3];
  EXPECT_EQ(c_number_to_chars(small, small + 3, 0.125).ec, std::errc::value_too_large);
}

TEST(FloatText, CWritesPowersOfTwoWithADigitMoreAtMost) {
  for (int exponent = -1022; exponent < 1024; ++exponent) {
    const std::string text = written_by_c(std::ldexp(1.0, exponent));
    EXPECT_LE(text.size(), written(std::ldexp(1.0, exponent)).size() + 1);
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), std::ldexp(1.0, exponent));
  }
}

TEST(FloatText, CReadsWhatTheStandardReadsAndNoMore) {
  for (const std::string_view text : {"",
                                      "-",
                                      "+1",
                                      " 1",
                                      "1 ",
                                      ".",
                                      "-.",
                                      "1.",
                                      ".5",
                                      "-.5e1",
                                      "1e",
                                      "1e+",
                                      "1e5",
                                      "1E-5x",
                                      "1e5.5",
                                      "1,5",
                                      "0x10",
                                      "1d5",
                                      "--1",
                                      "e5",
                                      "00012",
                                      "1e400",
                                      "-1e400",
                                      "1e-400",
                                      "-1e-400",
                                      "0e999999999999",
                                      "1e999999999999",
                                      "4.9e-324",
                                      "1e-310",
                                      "inf",
                                      "-INF",
                                      "infinity",
                                      "Infinit",
                                      "nan",
                                      "-NaN",
                                      "nan(",
                                      "nan(ab_1)",
                                      "nan()x",
                                      "nan(a b)",
                                      "in",
                                      "179769313486231580793e289",
                                      "0.1",
                                      "123456789.123456789123456789"}) {
    expect_same_reading(text);
  }
}

}  // namespace
}  // namespace g3r::io
