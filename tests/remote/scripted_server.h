// A server on this machine that answers as a test says: also as no honest server does.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace pcm::test {

struct HttpRequest {
    std::string method, path;
    std::map<std::string, std::string> headers;  // names in lower case
    // The range that is asked for; none where none is.
    std::optional<std::pair<std::uint64_t, std::uint64_t>> range() const;
};

struct HttpAnswer {
    int status = 200;
    std::vector<std::string> headers;  // whole lines; Content-Length is added where there is none
    std::string body;
    std::size_t cut_after = std::string::npos;  // bytes of the body, after which the connection is closed
    bool no_answer = false;                     // the connection is closed at once
};

using HttpHandler = std::function<HttpAnswer(const HttpRequest&)>;

class ScriptedServer {
public:
    explicit ScriptedServer(HttpHandler handler);
    ~ScriptedServer();
    ScriptedServer(const ScriptedServer&) = delete;
    ScriptedServer& operator=(const ScriptedServer&) = delete;

    std::string address(const std::string& path = "") const;  // "http://127.0.0.1:PORT/PATH"
    std::vector<HttpRequest> requests() const;                // so far
    void set_handler(HttpHandler handler);
    // Nothing is listening any more.
    void stop();

private:
    void accept_all();
    void serve(int connection);

    mutable std::mutex mutex_;
    HttpHandler handler_;
    std::vector<HttpRequest> requests_;
    std::vector<std::thread> threads_;
    std::vector<int> connections_;
    int listening_ = -1;
    int port_ = 0;
    std::atomic<bool> ending_{false};
    std::thread accepting_;
};

// The honest answer of a server with ranges and strong entity tags; `tag` without quotes, none where it is empty.
HttpAnswer answer_for(const HttpRequest& request, const std::string& bytes, const std::string& tag = "a");

// Answers from the files of a folder; the tags change with the files.
HttpHandler files_of(const std::filesystem::path& folder);

}  // namespace pcm::test
