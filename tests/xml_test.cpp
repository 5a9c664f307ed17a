#include "io/xml.h"

#include <gtest/gtest.h>

#include <string>

namespace g3r {
namespace {

// The parts as one text: begins as "<name a=value", ends as ">", texts in brackets, pieces joined.
class Written : public io::XmlEvents {
 public:
  void begin(const std::string& name, const std::vector<io::XmlAttribute>& attributes) override {
    out += "<" + name;
    for (const io::XmlAttribute& a : attributes) out += " " + a.name + "=" + a.value;
    in_text_ = false;
  }
  void end(const std::string& /*name*/) override {
    out += ">";
    in_text_ = false;
  }
  void text(const std::string& text) override {
    if (in_text_) out.pop_back();
    out += (in_text_ ? "" : "(") + text + ")";
    in_text_ = true;
  }

  std::string out;

 private:
  bool in_text_ = false;
};

std::string parts(const std::string& xml) {
  Written events;
  io::parse_xml(xml, events);
  return events.out;
}

TEST(Xml, PartsComeInTheirOrder) {
  EXPECT_EQ(parts("<a/>"), "<a>");
  EXPECT_EQ(parts("<?xml version=\"1.0\"?>\n<a b='1' c = \"2\">x<d:e /><!-- <f> --><?p <g> ?>y</a>\n"), "<a b=1 c=2(x)<d:e>(y)>");
  EXPECT_EQ(parts("<a>x<![CDATA[<b>&amp;]]>y</a >"), "<a(x<b>&amp;y)>");
  EXPECT_EQ(parts("<a><b></b><b>1</b></a>"), "<a<b><b(1)>>");
}

TEST(Xml, EntitiesAndNumbersBecomeCharacters) {
  EXPECT_EQ(parts("<a b='&lt;&quot;'>&amp;&gt;&apos;&#65;&#x42;&#xe9;&#8364;&#x1F600;</a>"), "<a b=<\"(&>'AB\u00e9\u20ac\U0001F600)>");
}

TEST(Xml, LineEndsAreLineFeedsAndBlanksInAttributes) {
  EXPECT_EQ(parts("<a b='1\r\n2\t3&#10;'>x\r\ny\rz\n</a>"), "<a b=1 2 3\n(x\ny\nz\n)>");
}

TEST(Xml, WhatIsNotXmlIsRefused) {
  for (const char* xml : {"",
                          " ",
                          "a",
                          "<a>",
                          "</a>",
                          "<a></b>",
                          "<a></a",
                          "<a/><b/>",
                          "<a/>x",
                          "x<a/>",
                          "<a",
                          "<a b>",
                          "<a b=1/>",
                          "<a b='1/>",
                          "<a b='1'c='2'/>",
                          "<a b='1' b='2'/>",
                          "<a b='<'/>",
                          "<1/>",
                          "< a/>",
                          "<a><!-- </a>",
                          "<a><![CDATA[</a>",
                          "<a>]]></a>",
                          "<![CDATA[]]><a/>",
                          "<a>&</a>",
                          "<a>&b;</a>",
                          "<a>&#0;</a>",
                          "<a>&#x110000;</a>",
                          "<a>&#xD800;</a>",
                          "<a>&#;</a>",
                          "<a>&#x;</a>",
                          "<a>&#-1;</a>",
                          "<!DOCTYPE a><a/>",
                          "<!DOCTYPE a [<!ENTITY b \"c\">]><a>&b;</a>",
                          "<a>\x01</a>",
                          "<a>\xFF</a>",
                          "<a>\xC0\x80</a>",
                          "<a>\xE2\x82</a>",
                          "<a>\xED\xA0\x80</a>",
                          "<a>\xEF\xBF\xBF</a>",
                          "<a>\xF5\x80\x80\x80</a>"}) {
    EXPECT_THROW(parts(xml), io::XmlError) << xml;
  }
}

TEST(Xml, EveryPrefixIsRefused) {
  const std::string xml = "<?xml version=\"1.0\"?><a b='1'>x<c/><!-- d -->&amp;<![CDATA[e]]>\u20ac</a>";
  for (std::size_t size = 0; size < xml.size(); ++size) EXPECT_THROW(parts(xml.substr(0, size)), io::XmlError) << size;
  EXPECT_EQ(parts(xml), "<a b=1(x)<c>(&e\u20ac)>");
}

TEST(Xml, ErrorsTellThePlace) {
  try {
    parts("<a>\n</b>");
    FAIL();
  } catch (const io::XmlError& error) {
    EXPECT_GE(error.offset, 4U);
    EXPECT_LE(error.offset, 8U);
  }
}

// Neither depth nor length takes more than time in proportion, or stack.
TEST(Xml, DeepAndLongTextsAreRead) {
  constexpr std::size_t kDeep = 200000;
  std::string xml;
  for (std::size_t i = 0; i < kDeep; ++i) xml += "<a>";
  for (std::size_t i = 0; i < kDeep; ++i) xml += "&#65;</a>";
  EXPECT_EQ(parts(xml).size(), 2 * kDeep + kDeep + 3 * kDeep);
}

}  // namespace
}  // namespace g3r
