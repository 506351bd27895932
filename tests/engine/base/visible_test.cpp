#include "engine/base/visible.h"

#include <gtest/gtest.h>

#include "engine/base/json.h"
#include "engine/base/text.h"

namespace lensproof::visible_test {

TEST(Visible, WritesOutWhatATerminalActsUpon) {
    EXPECT_EQ(visible("lens.toml:3: f/2.8, 5 µm, 鏡玉\n\ttab"), "lens.toml:3: f/2.8, 5 µm, 鏡玉\n\ttab");
    EXPECT_EQ(visible("\x1b[2J\x07\x7f\r"), "\\u001b[2J\\u0007\\u007f\\u000d");
    EXPECT_EQ(visible("a\u009b31m"), "a\\u009b31m");          // a control sequence's one-letter form
    EXPECT_EQ(visible("gnp.\u202etoml"), "gnp.\\u202etoml");  // reads backwards
    EXPECT_EQ(visible("\u2066a\u2069\u200b\ufeff\u061c"), "\\u2066a\\u2069\\u200b\\ufeff\\u061c");
    EXPECT_EQ(visible("\x9b\xc0\xaf\xed\xa0\x80\xf5\xe2\x82"),
              "\ufffd\ufffd\ufffd\ufffd\ufffd\ufffd\ufffd\ufffd\ufffd");
    EXPECT_EQ(visible(""), "");
}

// The start of a text for a message is the same, and not cut within a letter.
TEST(Visible, IsWhatMessagesQuote) {
    EXPECT_EQ(printable("µ\x1b[31m"), "µ\\u001b[31m");
    const std::string ninety_nine(99, 'x');
    EXPECT_EQ(printable(ninety_nine + "µ"), ninety_nine + "…");
    EXPECT_EQ(printable(ninety_nine + "yz"), ninety_nine + "y…");
}

// JSON says the same text by its own escapes, in keys too: a reader gets back what there was.
TEST(Visible, IsWhatJsonShows) {
    const std::string name = "a\u202eb\x1b[31m\u009b";
    const std::string text = Json{{name, name}}.dump();
    EXPECT_EQ(text, R"({"a\u202eb\u001b[31m\u009b":"a\u202eb\u001b[31m\u009b"})");
    const Json again = Json::parse(text, "x");
    EXPECT_EQ(again[name].text(), name);
}

}  // namespace lensproof::visible_test
