#include "pcm/remote/remote_object.h"

#include "pcm/system/error.h"
#include "tests/remote/scripted_server.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

namespace {

using namespace pcm;
using namespace pcm::test;

std::string some_bytes(std::size_t size)
{
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 31 + i / 251);
    return bytes;
}

const std::string content = some_bytes(5000);

HttpHandler honest(const std::string& tag = "a")
{
    return [tag](const HttpRequest& request) { return answer_for(request, content, tag); };
}

// Answers the first `count` requests with `bad`, and the others honestly.
HttpHandler at_first(int count, const HttpHandler& bad)
{
    auto left = std::make_shared<std::atomic<int>>(count);
    return
        [left, bad](const HttpRequest& request) { return (*left)-- > 0 ? bad(request) : answer_for(request, content); };
}

HttpAnswer status(int number, std::vector<std::string> headers = {})
{
    HttpAnswer answer;
    answer.status = number;
    answer.headers = std::move(headers);
    return answer;
}

std::string read(const RemoteObject& object, std::uint64_t offset, std::size_t bytes)
{
    std::string to(bytes, '\0');
    std::vector<RemoteRange> ranges{{offset, bytes, reinterpret_cast<std::byte*>(to.data()), 0}};
    object.read(ranges);
    to.resize(ranges[0].got);
    return to;
}

struct Refusal {
    ErrorCode code = ErrorCode::cancelled;
    std::string text;
};

Refusal refusal_of(const RemoteObject& object, std::uint64_t offset = 10, std::size_t bytes = 100)
{
    try {
        read(object, offset, bytes);
    } catch (const Error& error) {
        return {error.code(), error.what()};
    }
    return {};
}

TEST(RemoteObjectTest, RangesAreTheBytesThatWereAskedFor)
{
    ScriptedServer server(honest());
    const RemoteObject object(server.address("x"));
    EXPECT_FALSE(object.known());
    EXPECT_EQ(read(object, 10, 100), content.substr(10, 100));
    EXPECT_EQ(read(object, 4990, 100), content.substr(4990));
    EXPECT_EQ(read(object, 5000, 100), "");
    ASSERT_TRUE(object.known());
    EXPECT_EQ(object.known()->size, content.size());
    EXPECT_EQ(object.known()->tag, "\"a\"");
    EXPECT_EQ(object.ask(), *object.known());
    std::string a(50, ' '), b(70, ' ');
    std::vector<RemoteRange> ranges{{0, 50, reinterpret_cast<std::byte*>(a.data()), 0},
                                    {1000, 70, reinterpret_cast<std::byte*>(b.data()), 0}};
    object.read(ranges);
    EXPECT_EQ(a + b, content.substr(0, 50) + content.substr(1000, 70));
    EXPECT_EQ(server.requests()[0].headers.count("if-match"), 0u);
    for (std::size_t i : {1u, 2u, 4u, 5u}) EXPECT_EQ(server.requests()[i].headers.at("if-match"), "\"a\"") << i;
}

TEST(RemoteObjectTest, ABusyServerIsAskedAgainAndWaitedFor)
{
    for (const int number : {408, 429, 500, 502, 503, 504}) {
        ScriptedServer server(at_first(2, [&](const HttpRequest&) { return status(number); }));
        const RemoteObject object(server.address("x"));
        EXPECT_EQ(read(object, 10, 100), content.substr(10, 100)) << number;
        EXPECT_EQ(server.requests().size(), 3u);
    }
    ScriptedServer server(at_first(1, [](const HttpRequest&) { return status(503, {"Retry-After: 1"}); }));
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(read(RemoteObject(server.address("x")), 10, 100), content.substr(10, 100));
    EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
}

TEST(RemoteObjectTest, ConnectionsThatAreCutAreMadeAgain)
{
    const auto cut = [](std::size_t after) {
        return [after](const HttpRequest& request) {
            HttpAnswer answer = answer_for(request, content);
            answer.cut_after = after;
            return answer;
        };
    };
    const auto silent = [](const HttpRequest&) {
        HttpAnswer answer;
        answer.no_answer = true;
        return answer;
    };
    for (const HttpHandler& bad :
         {HttpHandler(cut(0)), HttpHandler(cut(50)), HttpHandler(cut(99)), HttpHandler(silent)}) {
        ScriptedServer server(at_first(3, bad));
        EXPECT_EQ(read(RemoteObject(server.address("x")), 10, 100), content.substr(10, 100));
    }
}

// A server, or a proxy before it, that sends what was not asked for.
TEST(RemoteObjectTest, LiesAboutLengthsAreNoBytes)
{
    const auto lie = [](const std::string& range, const std::string& body) {
        return [range, body](const HttpRequest&) {
            HttpAnswer answer = status(206, {"ETag: \"a\"", "Content-Range: " + range});
            answer.body = body;
            return answer;
        };
    };
    const std::string right = content.substr(10, 100);
    const std::pair<const char*, std::string> lies[] = {
        {"bytes 10-109/5000", content.substr(10, 99)},
        {"bytes 10-109/5000", content.substr(10, 101)},
        {"bytes 20-109/5000", content.substr(20, 90)},
        {"bytes 10-108/5000", content.substr(10, 99)},
        {"bytes 11-110/5000", right},
        {"bytes 10-109/*", right},
        {"bytes 10-109/100", right},
        {"bytes 109-10/5000", right},
        {"bytes 10-109/5000 and more", right},
        {"bytes -10-109/5000", right},
        {"bytes */5000", right},
        {"", right},
        {"bytes 10-109/18446744073709551616000", right},
    };
    for (const auto& [range, body] : lies) {
        ScriptedServer server(at_first(1, lie(range, body)));
        EXPECT_EQ(read(RemoteObject(server.address("x")), 10, 100), right) << range;
        EXPECT_EQ(server.requests().size(), 2u) << range;
    }
}

TEST(RemoteObjectTest, AFileThatWasReplacedIsNeverMixedWithTheOldOne)
{
    const std::string newer = some_bytes(5100);
    struct Case {
        const char* name;
        HttpHandler before, after;
    };
    const auto plain = [](const std::string& bytes, std::vector<std::string> headers) -> HttpHandler {
        return [bytes, headers](HttpRequest request) {
            request.headers.erase("if-match");  // a server that does not know it
            HttpAnswer answer = answer_for(request, bytes, "");
            answer.headers.insert(answer.headers.end(), headers.begin(), headers.end());
            return answer;
        };
    };
    const Case cases[] = {
        {"the server refuses", honest("a"), honest("b")},
        {"another tag", plain(content, {"ETag: \"a\""}), plain(content, {"ETag: \"b\""})},
        {"a weak tag", plain(content, {"ETag: W/\"a\""}), plain(content, {"ETag: W/\"b\""})},
        {"another time", plain(content, {"Last-Modified: Mon"}), plain(content, {"Last-Modified: Tue"})},
        {"another size", plain(content, {}), plain(newer, {})},
        {"without a tag", plain(content, {"ETag: \"a\""}), plain(content, {})},
    };
    for (const Case& one : cases) {
        ScriptedServer server(one.before);
        const RemoteObject object(server.address("x"));
        EXPECT_EQ(read(object, 10, 100), content.substr(10, 100)) << one.name;
        server.set_handler(one.after);
        const Refusal refusal = refusal_of(object);
        EXPECT_EQ(refusal.code, ErrorCode::io) << one.name;
        EXPECT_NE(refusal.text.find("replaced"), std::string::npos) << refusal.text;
        server.set_handler(one.before);
        EXPECT_EQ(read(object, 20, 100), content.substr(20, 100)) << one.name;
    }
}

// If-Match compares strongly: a weak tag in it would be refused by every server.
TEST(RemoteObjectTest, WeakTagsAreComparedHere)
{
    ScriptedServer server([](const HttpRequest& request) {
        if (request.headers.count("if-match")) return status(412);
        HttpAnswer answer = answer_for(request, content, "");
        answer.headers.push_back("ETag: W/\"a\"");
        return answer;
    });
    const RemoteObject object(server.address("x"));
    EXPECT_EQ(read(object, 10, 100) + read(object, 110, 100), content.substr(10, 200));
}

TEST(RemoteObjectTest, RedirectsAreFollowedOnTheSameServerOnly)
{
    ScriptedServer other(honest());
    ScriptedServer server([&](const HttpRequest& request) {
        if (request.path == "/far") return status(302, {"Location: " + other.address("x")});
        if (request.path == "/scheme") return status(302, {"Location: file:///etc/passwd"});
        if (request.path == "/guess") return status(302, {"Location: //" + other.address("x").substr(7)});
        if (request.path == "/circle") return status(302, {"Location: /circle"});
        if (request.path == "/none") return status(302);
        if (request.path == "/near") return status(301, {"Location: /x"});
        return answer_for(request, content);
    });
    const RemoteObject near(server.address("near"));
    EXPECT_EQ(read(near, 10, 100), content.substr(10, 100));
    EXPECT_EQ(read(near, 20, 100), content.substr(20, 100));
    EXPECT_EQ(server.requests().size(), 3u);  // where it leads is kept
    for (const char* const path : {"far", "scheme", "guess", "none"})
        EXPECT_EQ(refusal_of(RemoteObject(server.address(path))).code, ErrorCode::unsupported) << path;
    EXPECT_NE(refusal_of(RemoteObject(server.address("circle"))).text.find("circles"), std::string::npos);
    EXPECT_TRUE(other.requests().empty());
}

TEST(RemoteObjectTest, WhatDoesNotHelpToRepeatIsSaidAtOnce)
{
    const std::pair<int, ErrorCode> refusals[] = {{404, ErrorCode::not_found},   {410, ErrorCode::not_found},
                                                  {401, ErrorCode::permission},  {403, ErrorCode::permission},
                                                  {200, ErrorCode::unsupported}, {400, ErrorCode::io},
                                                  {204, ErrorCode::io},          {501, ErrorCode::io}};
    for (const auto& [number, code] : refusals) {
        ScriptedServer server([number = number](const HttpRequest&) { return status(number); });
        EXPECT_EQ(refusal_of(RemoteObject(server.address("x"))).code, code) << number;
        EXPECT_EQ(server.requests().size(), 1u) << number;
    }
}

// A server that knows no ranges sends all: of a large file that would take long, and all of memory if it were kept.
TEST(RemoteObjectTest, AWholeFileIsCutOff)
{
    ScriptedServer server([](const HttpRequest&) {
        HttpAnswer answer;
        answer.headers.push_back("Content-Length: 1000000000000");  // and so it never ends
        answer.body.resize(std::size_t{4} << 20);
        return answer;
    });
    EXPECT_EQ(refusal_of(RemoteObject(server.address("x"))).code, ErrorCode::unsupported);
}

TEST(RemoteObjectTest, WithoutAServerTheErrorSaysSoInTime)
{
    std::string address;
    {
        ScriptedServer server(honest());
        address = server.address("x");
    }
    const auto start = std::chrono::steady_clock::now();
    try {
        read(RemoteObject(address), 0, 10);
        FAIL();
    } catch (const Error& error) {
        EXPECT_TRUE(is_unreachable(error)) << error.what();
        EXPECT_NE(std::string(error.what()).find(address), std::string::npos) << error.what();
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(15));
}

TEST(RemoteObjectTest, ManyThreadsReadOneObject)
{
    std::atomic<int> count{0};
    ScriptedServer server([&](const HttpRequest& request) {
        if (++count % 7 == 0) return status(503);
        return answer_for(request, content);
    });
    const RemoteObject object(server.address("x"));
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < 8; ++i)
        threads.emplace_back([&, i] {
            for (std::size_t at = i * 10; at < 400; at += 40) EXPECT_EQ(read(object, at, 100), content.substr(at, 100));
        });
    for (std::thread& thread : threads) thread.join();
}

}  // namespace
