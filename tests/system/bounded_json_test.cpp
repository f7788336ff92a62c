#include "pcm/system/bounded_json.h"

#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <string>
#include <utility>

namespace pcm::test {
namespace {

std::string repeated(const std::string& piece, std::size_t times)
{
    std::string text;
    text.reserve(piece.size() * times);
    for (std::size_t i = 0; i < times; ++i) text += piece;
    return text;
}

std::string error_of(const std::string& text)
{
    try {
        parse_bounded_json(text);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::bad_format);
        return error.what();
    }
    return {};
}

TEST(BoundedJson, IsWhatTheTextStates)
{
    const std::string text = R"({"b": [1, -2, 2.5, 18446744073709551615, null, true, "x\u00e9"], "a": {"c": {}}})";
    EXPECT_TRUE(parse_bounded_json(text) == nlohmann::ordered_json::parse(text));
    EXPECT_NE(error_of("{\"a\": 1,}").find("not JSON"), std::string::npos);
    EXPECT_NE(error_of("").find("not JSON"), std::string::npos);
}

TEST(BoundedJson, DepthIsBounded)
{
    for (const auto& [open, close] : {std::pair<std::string, std::string>{"[", "]"}, {"{\"a\":", "}"}}) {
        EXPECT_EQ(error_of(repeated(open, 32) + "1" + repeated(close, 32)), "");
        EXPECT_NE(error_of(repeated(open, 33) + "1" + repeated(close, 33)).find("deeper than 32"), std::string::npos);
        EXPECT_NE(error_of(repeated(open, 5000000)).find("deeper than 32"), std::string::npos);
    }
}

// The growth of this process's peak while `work` runs in a child, bytes.
std::uint64_t memory_of(const std::function<void()>& work)
{
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
        const std::uint64_t before = peak_memory_bytes();
        work();
        const std::uint64_t grown = peak_memory_bytes() - before;
        const bool sent = write(ends[1], &grown, sizeof grown) == sizeof grown;
        _exit(sent ? 0 : 1);
    }
    std::uint64_t grown = ~std::uint64_t(0);
    EXPECT_EQ(read(ends[0], &grown, sizeof grown), static_cast<ssize_t>(sizeof grown));
    int status = 0;
    waitpid(child, &status, 0);
    close(ends[0]);
    close(ends[1]);
    return grown;
}

// Each kind of value that is short in the text and large in memory: refused before anything is kept. What is accepted
// takes little more than the bound.
// Not under the address sanitizer: a limit of memory, of which the sanitizer takes more itself.
TEST(BoundedJson, PCM_NOT_UNDER_ADDRESS(MemoryIsBounded))
{
    // A piece, and about what the parser takes for it, bytes.
    const std::pair<std::string, std::size_t> pieces[] = {{"[],", 72},
                                                          {"{},", 72},
                                                          {"0,", 32},
                                                          {"\"\",", 64},
                                                          {"{\"\":0},", 136},
                                                          {"[[]],", 144},
                                                          {"\"0123456789abcdef\",", 97}};
    for (const auto& [piece, bytes] : pieces) {
        SCOPED_TRACE(piece);
        const std::size_t times = 128000000 / bytes;
        const std::string too_much = "[" + repeated(piece, times * 21 / 20) + "0]";
        EXPECT_LT(memory_of([&] { error_of(too_much); }), 20u << 20);
        EXPECT_NE(error_of(too_much).find("more values than a list has"), std::string::npos);
        const std::string enough = "[" + repeated(piece, times * 19 / 20) + "0]";
        EXPECT_LT(memory_of([&] { parse_bounded_json(enough); }), 200u << 20);
    }
}

}  // namespace
}  // namespace pcm::test
