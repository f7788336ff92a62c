// One thread drives all transfers of a session (curl_multi); callers hand it their requests and wait.
#include "pcm/remote/curl/curl_module.h"

#include <curl/curl.h>
#include <openssl/sha.h>

#include <strings.h>
#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace pcm {
namespace {

// Requests of one call that are not answered yet.
struct Call {
    std::size_t left = 0;
};

struct Transfer {
    const TransferRequest* request = nullptr;
    TransferAnswer* answer = nullptr;
    Call* call = nullptr;
    CURL* handle = nullptr;
    curl_slist* headers = nullptr;
    std::array<char, CURL_ERROR_SIZE> error{};

    ~Transfer()
    {
        curl_slist_free_all(headers);
        if (handle) curl_easy_cleanup(handle);
    }
};

// In hexadecimal digits.
std::string sha256(const void* content, std::uint64_t bytes)
{
    std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
    SHA256(static_cast<const unsigned char*>(content), static_cast<std::size_t>(bytes), digest.data());
    std::string text;
    for (const unsigned char byte : digest) {
        std::array<char, 3> two{};
        std::snprintf(two.data(), two.size(), "%02x", byte);
        text += two.data();
    }
    return text;
}

std::size_t take_body(char* bytes, std::size_t, std::size_t size, void* to)
{
    auto& transfer = *static_cast<Transfer*>(to);
    TransferAnswer& answer = *transfer.answer;
    long status = 0;
    curl_easy_getinfo(transfer.handle, CURLINFO_RESPONSE_CODE, &status);
    const bool sent = transfer.request->method;
    if (status != 206 && !sent) return size;  // a page about an error; how much of one is read is limited below
    const auto room = static_cast<std::size_t>(transfer.request->bytes - answer.got);
    if (room > 0) std::memcpy(static_cast<char*>(transfer.request->to) + answer.got, bytes, std::min(room, size));
    answer.got += std::min(room, size);
    if (sent) return size;
    answer.more_than_asked = size > room;
    return answer.more_than_asked ? 0 : size;
}

// The length is known before the body comes: a server that sends all of a large file is cut off.
int check_progress(void* to, curl_off_t, curl_off_t now, curl_off_t, curl_off_t)
{
    constexpr curl_off_t most_of_page = 1 << 20;
    auto& transfer = *static_cast<Transfer*>(to);
    long status = 0;
    curl_easy_getinfo(transfer.handle, CURLINFO_RESPONSE_CODE, &status);
    if (status == 206 || now <= most_of_page) return 0;
    transfer.answer->more_than_asked = true;
    return 1;
}

template <std::size_t N>
void keep(char (&to)[N], const std::string& value)
{
    if (value.size() < N) std::snprintf(to, N, "%s", value.c_str());
}

std::size_t take_header(char* line, std::size_t, std::size_t size, void* to)
{
    TransferAnswer& answer = *static_cast<Transfer*>(to)->answer;
    const std::string text(line, size);
    const std::size_t colon = text.find(':');
    if (text.rfind("HTTP/", 0) == 0) {  // a new answer, after one that was only for the time being
        answer.tag[0] = answer.modified[0] = answer.range[0] = answer.location[0] = answer.bucket_region[0] = 0;
        answer.retry_after = 0;
    }
    if (colon == std::string::npos) return size;
    const std::size_t first = text.find_first_not_of(" \t", colon + 1), last = text.find_last_not_of(" \t\r\n");
    const std::string value = first <= last && first != std::string::npos ? text.substr(first, last - first + 1) : "";
    const auto is = [&](const char* name) {
        return colon == std::strlen(name) && ::strncasecmp(text.c_str(), name, colon) == 0;
    };
    if (is("etag")) keep(answer.tag, value);
    if (is("last-modified")) keep(answer.modified, value);
    if (is("content-range")) keep(answer.range, value);
    if (is("location")) keep(answer.location, value);
    if (is("x-amz-bucket-region")) keep(answer.bucket_region, value);
    if (is("retry-after")) answer.retry_after = std::strtod(value.c_str(), nullptr);
    return size;
}

class Session {
public:
    explicit Session(const TransferOptions& options)
        : options_(options), certificates_(options.certificates ? options.certificates : ""), multi_(curl_multi_init())
    {
        if (!multi_) return;
        curl_multi_setopt(multi_, CURLMOPT_PIPELINING, CURLPIPE_MULTIPLEX);
        curl_multi_setopt(multi_, CURLMOPT_MAX_HOST_CONNECTIONS, static_cast<long>(options.connections));
        thread_ = std::thread([this] { drive(); });
    }

    ~Session()
    {
        if (!multi_) return;
        {
            const std::lock_guard lock(mutex_);
            ending_ = true;
        }
        curl_multi_wakeup(multi_);
        thread_.join();
        curl_multi_cleanup(multi_);
    }

    bool works() const { return multi_ != nullptr; }

    void perform(const TransferRequest* requests, TransferAnswer* answers, std::size_t count)
    {
        Call call;
        std::vector<std::unique_ptr<Transfer>> made;
        for (std::size_t i = 0; i < count; ++i) {
            answers[i] = TransferAnswer();
            auto transfer = std::make_unique<Transfer>();
            transfer->request = &requests[i];
            transfer->answer = &answers[i];
            transfer->call = &call;
            if (prepare(*transfer))
                made.push_back(std::move(transfer));
            else
                keep(answers[i].message, "libcurl cannot make the request");
        }
        std::unique_lock lock(mutex_);
        call.left = made.size();
        for (auto& transfer : made) waiting_.push_back(std::move(transfer));
        curl_multi_wakeup(multi_);
        answered_.wait(lock, [&] { return call.left == 0; });
    }

private:
    bool prepare(Transfer& transfer) const;
    void send_content(Transfer& transfer) const;
    void sign(Transfer& transfer) const;
    void drive();
    void start_waiting();
    void end(CURL* handle, CURLcode result);

    TransferOptions options_;
    std::string certificates_;
    CURLM* multi_;
    std::mutex mutex_;
    std::condition_variable answered_;
    std::deque<std::unique_ptr<Transfer>> waiting_;
    std::vector<std::unique_ptr<Transfer>> running_;  // only the thread uses it
    bool ending_ = false;
    std::thread thread_;
};

bool Session::prepare(Transfer& transfer) const
{
    const TransferRequest& request = *transfer.request;
    CURL* const handle = transfer.handle = curl_easy_init();
    if (!handle) return false;
    curl_easy_setopt(handle, CURLOPT_URL, request.url);
    curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(handle, CURLOPT_FOLLOWLOCATION, 0L);
    curl_easy_setopt(handle, CURLOPT_NETRC, static_cast<long>(CURL_NETRC_IGNORED));
    curl_easy_setopt(handle, CURLOPT_PATH_AS_IS, 1L);
    curl_easy_setopt(handle, CURLOPT_HTTP_VERSION, static_cast<long>(CURL_HTTP_VERSION_2TLS));
    curl_easy_setopt(handle, CURLOPT_PIPEWAIT, request.new_connection ? 0L : 1L);
    curl_easy_setopt(handle, CURLOPT_FRESH_CONNECT, request.new_connection ? 1L : 0L);
    curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(handle, CURLOPT_USERAGENT, "pcmlab");
    curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(1000 * options_.connect_seconds));
    curl_easy_setopt(handle, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(handle, CURLOPT_LOW_SPEED_TIME, static_cast<long>(options_.stall_seconds));
    curl_easy_setopt(handle, CURLOPT_ERRORBUFFER, transfer.error.data());
    curl_easy_setopt(handle, CURLOPT_PRIVATE, &transfer);
    curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, take_body);
    curl_easy_setopt(handle, CURLOPT_WRITEDATA, &transfer);
    curl_easy_setopt(handle, CURLOPT_HEADERFUNCTION, take_header);
    curl_easy_setopt(handle, CURLOPT_HEADERDATA, &transfer);
    curl_easy_setopt(handle, CURLOPT_XFERINFOFUNCTION, check_progress);
    curl_easy_setopt(handle, CURLOPT_XFERINFODATA, &transfer);
    curl_easy_setopt(handle, CURLOPT_NOPROGRESS, 0L);
    if (!certificates_.empty()) curl_easy_setopt(handle, CURLOPT_CAINFO, certificates_.c_str());
    if (request.method) {
        send_content(transfer);
    } else if (request.bytes == 0) {
        curl_easy_setopt(handle, CURLOPT_NOBODY, 1L);
    } else {
        const std::string range =
            std::to_string(request.offset) + "-" + std::to_string(request.offset + request.bytes - 1);
        curl_easy_setopt(handle, CURLOPT_RANGE, range.c_str());
    }
    if (request.if_match)
        transfer.headers = curl_slist_append(transfer.headers, (std::string("If-Match: ") + request.if_match).c_str());
    sign(transfer);
    if (transfer.headers) curl_easy_setopt(handle, CURLOPT_HTTPHEADER, transfer.headers);
    return true;
}

void Session::send_content(Transfer& transfer) const
{
    constexpr double more_patience = 6;  // a server puts parts together before it answers
    const TransferRequest& request = *transfer.request;
    curl_easy_setopt(transfer.handle, CURLOPT_CUSTOMREQUEST, request.method);
    curl_easy_setopt(transfer.handle, CURLOPT_LOW_SPEED_TIME,
                     static_cast<long>(more_patience * options_.stall_seconds));
    if (std::strcmp(request.method, "DELETE") == 0) return;
    curl_easy_setopt(transfer.handle, CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(request.content_bytes));
    curl_easy_setopt(transfer.handle, CURLOPT_POSTFIELDS, request.content_bytes > 0 ? request.content : "");
    transfer.headers = curl_slist_append(transfer.headers, "Content-Type: application/octet-stream");
    constexpr long permission_ms = 200;  // the longest wait for the server's permission to send a large content
    curl_easy_setopt(transfer.handle, CURLOPT_EXPECT_100_TIMEOUT_MS, permission_ms);
}

void Session::sign(Transfer& transfer) const
{
    const TransferRequest& request = *transfer.request;
    if (!request.key_id) return;
    curl_easy_setopt(transfer.handle, CURLOPT_AWS_SIGV4, (std::string("aws:amz:") + request.region + ":s3").c_str());
    curl_easy_setopt(transfer.handle, CURLOPT_USERNAME, request.key_id);
    curl_easy_setopt(transfer.handle, CURLOPT_PASSWORD, request.secret);
    if (request.session_token)
        transfer.headers = curl_slist_append(transfer.headers,
                                             (std::string("X-Amz-Security-Token: ") + request.session_token).c_str());
    // The checksum of what is sent, which S3 wants stated.
    transfer.headers = curl_slist_append(
        transfer.headers, ("X-Amz-Content-Sha256: " + sha256(request.content, request.content_bytes)).c_str());
}

void Session::start_waiting()
{
    std::deque<std::unique_ptr<Transfer>> fresh;
    {
        const std::lock_guard lock(mutex_);
        fresh.swap(waiting_);
    }
    for (auto& transfer : fresh) {
        CURL* const handle = transfer->handle;
        running_.push_back(std::move(transfer));
        if (curl_multi_add_handle(multi_, handle) != CURLM_OK) end(handle, CURLE_FAILED_INIT);
    }
}

void Session::end(CURL* handle, CURLcode result)
{
    const auto found = std::find_if(running_.begin(), running_.end(),
                                    [&](const std::unique_ptr<Transfer>& one) { return one->handle == handle; });
    const std::unique_ptr<Transfer> transfer = std::move(*found);
    running_.erase(found);
    TransferAnswer& answer = *transfer->answer;
    long status = 0;
    curl_off_t length = -1;
    curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
    curl_easy_getinfo(handle, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &length);
    answer.body = length > 0 ? static_cast<std::uint64_t>(length) : 0;
    answer.status = static_cast<int>(status);
    if (result != CURLE_OK && !answer.more_than_asked) {
        if (status == 206 || status == 200 || result != CURLE_PARTIAL_FILE) answer.status = 0;
        keep(answer.message, transfer->error[0] ? transfer->error.data() : curl_easy_strerror(result));
    }
    const std::lock_guard lock(mutex_);
    --transfer->call->left;
    answered_.notify_all();
}

void Session::drive()
{
    for (;;) {
        {
            const std::lock_guard lock(mutex_);
            if (ending_) return;
        }
        start_waiting();
        int running = 0, left = 0;
        curl_multi_perform(multi_, &running);
        while (const CURLMsg* const message = curl_multi_info_read(multi_, &left))
            if (message->msg == CURLMSG_DONE) {
                CURL* const handle = message->easy_handle;
                const CURLcode result = message->data.result;
                curl_multi_remove_handle(multi_, handle);
                end(handle, result);
            }
        curl_multi_poll(multi_, nullptr, 0, 1000, nullptr);
    }
}

void* open_session(const TransferOptions* options)
{
    static const CURLcode started = curl_global_init(CURL_GLOBAL_DEFAULT);
    if (started != CURLE_OK) return nullptr;
    auto session = std::make_unique<Session>(*options);
    return session->works() ? session.release() : nullptr;
}

void close_session(void* session) { delete static_cast<Session*>(session); }

void perform_all(void* session, const TransferRequest* requests, TransferAnswer* answers, std::size_t count)
{
    static_cast<Session*>(session)->perform(requests, answers, count);
}

}  // namespace
}  // namespace pcm

extern "C" __attribute__((visibility("default"))) const void* pcm_transfer_functions()
{
    static const pcm::TransferFunctions functions = {pcm::curl_module_version, pcm::open_session, pcm::close_session,
                                                     pcm::perform_all};
    return &functions;
}
