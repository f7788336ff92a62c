// Requests of this process over one session of libcurl, which is loaded when the first address is opened, and how long
// one that fails is repeated. Any number of threads.
#pragma once

#include "pcm/remote/curl/curl_module.h"
#include "pcm/remote/request_target.h"

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace pcm {

// Throws Error(unsupported) where the module with libcurl is not here.
void require_transfers(const std::filesystem::path& address);

// Performs all of them at once and counts them (system/work_done.h).
std::vector<TransferAnswer> perform_transfers(const std::vector<TransferRequest>& requests);

// Has the request signed with the keys of the target, if it has any; their texts are the target's.
void sign(TransferRequest& request, const RequestTarget& target);

// HTTP's words for "try again later".
bool is_busy(int status);

// What a failed try is worth: a pause that grows, with some chance in it so that many readers do not come back
// together.
class Patience {
public:
    // Waits, for as long as the server asks if it does; false where that would end `most_seconds` after the start, or
    // later.
    bool wait(double retry_after, double most_seconds);

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    double next_ = 0.2;  // seconds
};

// Why the latest request of this process is to be sent again, as text for a person; empty when it was
// answered, or given up. Any thread.
std::string network_trouble();
void set_network_trouble(const std::string& text);

// The text of an error that no server answered begins so.
inline constexpr const char* unreachable_text = "the server cannot be reached: ";

}  // namespace pcm
