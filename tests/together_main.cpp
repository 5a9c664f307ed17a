// The program of several tests (together.cmake): runs those of the named sources, or all.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (argc == 1) return RUN_ALL_TESTS();
  const std::set<std::string> wanted(argv + 1, argv + argc);
  std::set<std::string> found;
  std::string filter;
  const testing::UnitTest& tests = *testing::UnitTest::GetInstance();
  for (int s = 0; s < tests.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *tests.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const testing::TestInfo& test = *suite.GetTestInfo(t);
      const std::string source = std::filesystem::path(test.file()).stem().string();
      if (wanted.count(source) == 0) continue;
      found.insert(source);
      filter += std::string(suite.name()) + "." + test.name() + ":";
    }
  }
  for (const std::string& name : wanted) {
    if (found.count(name) > 0) continue;
    std::fprintf(stderr, "no test of %s.cpp is in this program\n", name.c_str());
    return 1;
  }
  GTEST_FLAG_SET(filter, filter);
  return RUN_ALL_TESTS();
}
