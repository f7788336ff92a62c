// One file behind an address: ranges of its bytes, asked for again where a network fails, and never bytes of a file
// and of another that has replaced it.
#pragma once

#include "pcm/remote/request_target.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

class Error;
struct TransferRequest;

struct RemoteRange {
    std::uint64_t offset = 0;
    std::size_t bytes = 0;  // more than none
    std::byte* to = nullptr;
    std::size_t got = 0;  // fewer than `bytes` only at the end of the file
};

// What the file is now: later answers must say the same.
struct RemoteVersion {
    std::string tag;         // ETag; empty where the server gives none
    std::string modified;    // Last-Modified; empty likewise
    std::uint64_t size = 0;  // bytes
    bool operator==(const RemoteVersion& o) const { return tag == o.tag && modified == o.modified && size == o.size; }
    bool operator!=(const RemoteVersion& o) const { return !(*this == o); }
};

// Any number of threads. What throws throws Error(not_found | permission | unsupported | io) and names the address;
// is_unreachable() of it is true where no server answered. Where a connection fails or a server is busy (408, 429 and
// 5xx, with the wait that it asks for) a request is repeated over a new connection for a while;
// after a request without any answer the next ones are tried once.
class RemoteObject {
public:
    static constexpr double most_seconds = 20;
    static constexpr double most_seconds_of_first = 3;  // while the server has not answered yet

    // Throws what Url::parse() and target_of() throw, and Error(unsupported) where the module with libcurl is not here.
    explicit RemoteObject(const std::filesystem::path& address);

    const std::filesystem::path& address() const { return address_; }

    // What is known of the file, from the first answer on.
    std::optional<RemoteVersion> known() const;
    // Takes the file for this version from now on. Only before the first answer.
    void assume(const RemoteVersion& version) const;

    // All ranges at once. Throws Error(io) when the file has been replaced since the first answer.
    void read(std::vector<RemoteRange>& ranges) const;

    // Asks what the file is now; nothing is kept.
    RemoteVersion ask() const;

private:
    struct Try;
    bool accept(Try& one) const;
    bool accept_range(Try& one) const;
    bool follow(Try& one) const;
    void learn(const Try& one, std::uint64_t size) const;
    TransferRequest request_of(const Try& one, bool new_connection) const;
    const Try* perform_once(std::vector<Try>& tries, bool new_connections) const;
    void perform(std::vector<Try>& tries) const;
    [[noreturn]] void refuse(const Try& one) const;
    [[noreturn]] void refuse_replaced() const;

    std::filesystem::path address_;
    RequestTarget target_;
    mutable std::mutex mutex_;
    mutable std::string url_;  // where the server sent us, on itself
    mutable std::optional<RemoteVersion> version_;
    mutable std::atomic<bool> answered_{false};  // the server, ever
    mutable std::atomic<bool> gone_{false};      // the last request was given up without an answer
};

// Whether the error is that no server answered.
bool is_unreachable(const Error& error);
// The same of an error's text, which is all that a cache keeps of it.
bool is_unreachable(const std::string& text);
// Whether an error's text is that the file has been replaced since it was opened.
bool is_replaced(const std::string& text);

}  // namespace pcm
