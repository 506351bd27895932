// tests/engine/base/json_test.cpp — what is written is JSON to another program, and what is read is named where it is
// wrong.
#include "engine/base/json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>

#include "engine/base/json_archive.h"
#include "tests/complaint.h"

namespace lensproof::json_test {

Json example() {
    Json json{{"whole", -3},
              {"large", std::uint64_t{18446744073709551615U}},
              {"number", 0.1},
              {"none", std::optional<double>()},
              {"text", "quote \" and \n line"},
              {"list", std::vector<double>{1.5, 2.0}},
              {"empty", Json::list()},
              {"object", {{"a", true}, {"b", Json::object()}}}};
    json["later"].push_back({{"key", 1}});
    return json;
}

// The same bytes as the library's own writer, in one line and indented.
TEST(Json, IsWrittenAsTheLibraryWritesIt) {
    const auto library = nlohmann::ordered_json::parse(example().dump());
    EXPECT_EQ(library.dump(), example().dump());
    EXPECT_EQ(library.dump(2), example().dump(2));
    EXPECT_EQ(library["object"]["a"], true);
    EXPECT_EQ(library["later"][0]["key"], 1);
    EXPECT_TRUE(library["none"].is_null());
}

TEST(Json, ReadsBackEveryBit) {
    EXPECT_EQ(Json::parse(example().dump(1), "memory"), example());
    for (const double number : {1.0 / 3.0, 5e-324, 1.7976931348623157e308, -0.0}) {
        const double back = Json::parse(Json(number).dump(), "memory").number();
        EXPECT_EQ(back, number);
        EXPECT_EQ(std::signbit(back), std::signbit(number));
    }
}

TEST(Json, HasNoNumbersThatAreNone) {
    EXPECT_TRUE(Json(std::nan("")).is_null());
    EXPECT_EQ(Json(std::numeric_limits<double>::infinity()).dump(), "null");
    EXPECT_EQ(Json("\xff").dump(), "\"\ufffd\"");
}

// nlohmann's rule: pairs that begin with a text are members, everything else is a list.
TEST(Json, PairsThatBeginWithATextAreAnObject) {
    EXPECT_TRUE((Json{{"a", 1}, {"b", 2}}).is_object());
    EXPECT_TRUE((Json{{"a", 1}, {2, 2}}).is_list());
    EXPECT_TRUE((Json{"a", 1}).is_list());
    EXPECT_TRUE(Json::list({{"a", 1}, {"b", 2}}).is_list());
}

TEST(Json, TheLastOfTheSameKeyCounts) {
    EXPECT_EQ(Json::parse(R"({"a": 1, "b": 2, "a": 3})", "memory").dump(), R"({"a":3,"b":2})");
}

TEST(Json, AsksForWhatIsNotThereInVain) {
    const Json json = example();
    EXPECT_TRUE(json["nothing"]["of"]["it"].is_null());
    EXPECT_TRUE(json["text"].elements().empty());
    EXPECT_EQ(json.size(), 9U);
}

TEST(Json, NodesSayWhereTheyAre) {
    const JsonNode top = JsonNode::parse(R"({"a": {"b": [1, "x", null]}})", "file.json");
    EXPECT_EQ(complaint_about([&] { std::ignore = top.at("a").at("b").numbers(); }),
              "file.json: a.b[1] is \"x\": expected a finite number");
    EXPECT_EQ(complaint_about([&] { std::ignore = top.at("a").at("c"); }),
              "file.json: a.c is missing, and expected there");
    EXPECT_EQ(complaint_about([&] { std::ignore = top.at("a").elements(); }),
              "file.json: a is {\"b\":[1,\"x\",null]}: expected a list");
    EXPECT_EQ(complaint_about([] { JsonNode::parse("{", "file.json"); }), "file.json: not JSON at byte 2");
    EXPECT_EQ(complaint_about([] { JsonNode::parse(std::string(100000, '['), "deep.json"); }),
              "deep.json: more than 64 brackets inside one another");
}

struct Leaf {
    double x = 0.0;
    std::optional<int> count;
};

struct Tree {
    std::string name;
    bool late = true;
    std::map<std::string, std::vector<Leaf>> leaves;
    std::vector<double> matrix;
};

void fields(JsonArchive& json, Leaf& leaf, double scale) {
    json.field("x", leaf.x).optional("count", leaf.count).derived("scaled", scale * leaf.x);
}
void fields(JsonArchive& json, Tree& tree) {
    json.constant("schema", 2, "2")
        .field("name", tree.name)
        .added("late", tree.late)
        .optional("leaves", tree.leaves, 10.0)
        .rows("matrix", tree.matrix, 2, 2, "two rows");
}

// One description writes and reads: what is written is read back to the same bytes, a value that an older file lacks
// keeps its own, and what is damaged is named by its place.
TEST(JsonArchive, DescribesATypeOnce) {
    const Tree tree{"oak", false, {{"a", {{0.5, 3}, {0.25, {}}}}}, {1, 2, 3, 4}};
    const std::string text = to_json(tree).dump();
    EXPECT_EQ(text, R"({"schema":2,"name":"oak","late":false,"leaves":{"a":[{"x":0.5,"count":3,"scaled":5.0},)"
                    R"({"x":0.25,"scaled":2.5}]},"matrix":[[1.0,2.0],[3.0,4.0]]})");
    const auto read = [](const std::string& file) { return from_json<Tree>(JsonNode::parse(file, "f")); };
    EXPECT_EQ(to_json(read(text)).dump(), text);
    EXPECT_TRUE(read(R"({"schema":2,"name":"","matrix":[[0,0],[0,0]]})").late);
    const auto complaint = [&](const std::string& file) { return complaint_about([&] { read(file); }); };
    EXPECT_EQ(complaint(R"({"schema":1})"), "f: schema is 1: expected 2");
    EXPECT_EQ(complaint(R"({"schema":2,"name":""})"), "f: matrix is missing, and expected there");
    EXPECT_EQ(complaint(R"({"schema":2,"name":"","leaves":{"a":[{"x":"1"}]}})"),
              "f: leaves.a[0].x is \"1\": expected a finite number");
    EXPECT_EQ(complaint(R"({"schema":2,"name":"","matrix":[[0,0]]})"), "f: matrix is [[0,0]]: expected two rows");
    EXPECT_EQ(complaint(R"({"schema":2,"name":"","matrix":[[],[]]})"),
              "f: matrix[0] is []: expected a list of 2 numbers");
}

}  // namespace lensproof::json_test
