#include "tests/remote/scripted_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace pcm::test {
namespace {

void send_all(int connection, const char* bytes, std::size_t size)
{
    while (size > 0) {
        const ssize_t sent = ::send(connection, bytes, size, MSG_NOSIGNAL);
        if (sent <= 0) return;
        bytes += sent;
        size -= static_cast<std::size_t>(sent);
    }
}

// The head of the next request of a connection; none at its end.
std::optional<HttpRequest> read_request(int connection, std::string& kept)
{
    while (kept.find("\r\n\r\n") == std::string::npos) {
        char bytes[4096];
        const ssize_t got = ::recv(connection, bytes, sizeof bytes, 0);
        if (got <= 0) return std::nullopt;
        kept.append(bytes, static_cast<std::size_t>(got));
    }
    const std::size_t end = kept.find("\r\n\r\n");
    std::istringstream lines(kept.substr(0, end));
    kept.erase(0, end + 4);
    HttpRequest request;
    lines >> request.method >> request.path;
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        const std::size_t colon = line.find(':');
        if (colon == std::string::npos) continue;
        std::string name = line.substr(0, colon);
        for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        const std::size_t first = line.find_first_not_of(' ', colon + 1), last = line.find_last_not_of("\r ");
        request.headers[name] = first == std::string::npos ? "" : line.substr(first, last - first + 1);
    }
    return request;
}

std::string head_of(const HttpRequest& request, const HttpAnswer& answer)
{
    std::string head = "HTTP/1.1 " + std::to_string(answer.status) + " X\r\n";
    bool has_length = false;
    for (const std::string& line : answer.headers) {
        head += line + "\r\n";
        has_length = has_length || line.rfind("Content-Length:", 0) == 0;
    }
    if (!has_length && (request.method != "HEAD" || !answer.body.empty()))
        head += "Content-Length: " + std::to_string(answer.body.size()) + "\r\n";
    return head + "\r\n";
}

}  // namespace

std::optional<std::pair<std::uint64_t, std::uint64_t>> HttpRequest::range() const
{
    const auto found = headers.find("range");
    if (found == headers.end()) return std::nullopt;
    unsigned long long first = 0, last = 0;
    if (std::sscanf(found->second.c_str(), "bytes=%llu-%llu", &first, &last) != 2) return std::nullopt;
    return std::pair<std::uint64_t, std::uint64_t>(first, last);
}

ScriptedServer::ScriptedServer(HttpHandler handler) : handler_(std::move(handler))
{
    listening_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof place;
    if (::bind(listening_, reinterpret_cast<sockaddr*>(&place), size) != 0 || ::listen(listening_, 64) != 0 ||
        ::getsockname(listening_, reinterpret_cast<sockaddr*>(&place), &size) != 0)
        throw std::runtime_error("cannot listen on this machine");
    port_ = ntohs(place.sin_port);
    accepting_ = std::thread([this] { accept_all(); });
}

ScriptedServer::~ScriptedServer() { stop(); }

void ScriptedServer::stop()
{
    if (ending_.exchange(true)) return;
    ::shutdown(listening_, SHUT_RDWR);
    accepting_.join();
    ::close(listening_);
    {
        const std::lock_guard lock(mutex_);
        for (const int connection : connections_) ::shutdown(connection, SHUT_RDWR);
    }
    for (std::thread& thread : threads_) thread.join();
}

std::string ScriptedServer::address(const std::string& path) const
{
    return "http://127.0.0.1:" + std::to_string(port_) + "/" + path;
}

std::vector<HttpRequest> ScriptedServer::requests() const
{
    const std::lock_guard lock(mutex_);
    return requests_;
}

void ScriptedServer::set_handler(HttpHandler handler)
{
    const std::lock_guard lock(mutex_);
    handler_ = std::move(handler);
}

void ScriptedServer::accept_all()
{
    while (!ending_) {
        const int connection = ::accept(listening_, nullptr, nullptr);
        if (connection < 0) continue;
        const std::lock_guard lock(mutex_);
        connections_.push_back(connection);
        threads_.emplace_back([this, connection] { serve(connection); });
    }
}

void ScriptedServer::serve(int connection)
{
    std::string kept;
    while (const std::optional<HttpRequest> request = read_request(connection, kept)) {
        HttpHandler handler;
        {
            const std::lock_guard lock(mutex_);
            requests_.push_back(*request);
            handler = handler_;
        }
        const HttpAnswer answer = handler(*request);
        if (answer.no_answer) break;
        const std::string head = head_of(*request, answer);
        send_all(connection, head.data(), head.size());
        if (request->method == "HEAD") continue;
        send_all(connection, answer.body.data(), std::min(answer.cut_after, answer.body.size()));
        if (answer.cut_after < answer.body.size()) break;
    }
    const std::lock_guard lock(mutex_);
    connections_.erase(std::find(connections_.begin(), connections_.end(), connection));
    ::close(connection);
}

HttpAnswer answer_for(const HttpRequest& request, const std::string& bytes, const std::string& tag)
{
    HttpAnswer answer;
    if (!tag.empty()) answer.headers.push_back("ETag: \"" + tag + "\"");
    const auto match = request.headers.find("if-match");
    if (match != request.headers.end() && match->second != "\"" + tag + "\"") {
        answer.status = 412;
        return answer;
    }
    const auto range = request.range();
    const std::string size = std::to_string(bytes.size());
    if (!range) {
        if (request.method == "HEAD") answer.headers.push_back("Content-Length: " + size);
        answer.body = request.method == "HEAD" ? "" : bytes;
    } else if (range->first >= bytes.size()) {
        answer.status = 416;
        answer.headers.push_back("Content-Range: bytes */" + size);
    } else {
        const std::uint64_t last = std::min<std::uint64_t>(range->second, bytes.size() - 1);
        answer.status = 206;
        answer.headers.push_back("Content-Range: bytes " + std::to_string(range->first) + "-" + std::to_string(last) +
                                 "/" + size);
        answer.body = bytes.substr(range->first, last - range->first + 1);
    }
    return answer;
}

HttpHandler files_of(const std::filesystem::path& folder)
{
    return [folder](const HttpRequest& request) {
        std::ifstream in(folder / request.path.substr(1), std::ios::binary);
        if (!in || request.path.find("..") != std::string::npos)
            return HttpAnswer{404, {}, "", std::string::npos, false};
        const std::string bytes{std::istreambuf_iterator<char>(in), {}};
        return answer_for(request, bytes, std::to_string(std::hash<std::string>()(bytes)));
    };
}

}  // namespace pcm::test
