// A build without LASzip and libE57Format: this program has the sources that stand in for their readers, which come before the library's.
#include <g3r/io.h>
#include <gtest/gtest.h>

#include "io_samples.h"

namespace g3r {
namespace {

using samples::message_of;

TEST(FormatsLeftOut, AreRefusedWithTheNameOfAConverter) {
  std::string laz = samples::written(samples::helix(5), "a.las");
  laz[104] = static_cast<char>(laz[104] | 0x80);
  EXPECT_NE(message_of(laz).find("laszip -i in.laz"), std::string::npos) << message_of(laz);
  EXPECT_NE(message_of("ASTM-E57 whatever").find("CloudCompare"), std::string::npos) << message_of("ASTM-E57 whatever");
}

TEST(FormatsLeftOut, LazIsNotWritten) {
  const samples::Folder folder;
  EXPECT_THROW(check_output(folder.path("a.laz"), {}, false), Unavailable);
  EXPECT_THROW(write_cloud(folder.path("a.laz"), samples::helix(5), nullptr, nullptr), Unavailable);
  EXPECT_EQ(folder.files(), 0U);
}

}  // namespace
}  // namespace g3r
