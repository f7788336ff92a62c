#include "pcm/remote/remote_object.h"

#include "pcm/remote/transfers.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cstdio>

namespace pcm {
namespace {

constexpr int most_redirects = 5;

// "bytes 0-9/200", or "bytes */200" for a range beyond the end.
struct StatedRange {
    std::uint64_t first = 0, last = 0, size = 0;
    bool empty = false;
};

constexpr const char* replaced_text = "this file has been replaced on the server since it was opened";

std::optional<StatedRange> parse_range(const char* text)
{
    StatedRange range;
    unsigned long long first = 0, last = 0, size = 0;
    int end = 0;
    if (std::sscanf(text, "bytes */%20llu%n", &size, &end) == 1 && text[end] == 0) {
        range.empty = true;
    } else if (std::sscanf(text, "bytes %20llu-%20llu/%20llu%n", &first, &last, &size, &end) != 3 || text[end] != 0 ||
               first > last || last >= size) {
        return std::nullopt;
    }
    range.first = first;
    range.last = last;
    range.size = size;
    return range;
}

std::string server_of(const std::string& url) { return url.substr(0, url.find('/', url.find("://") + 3)); }

}  // namespace

// A request, until it is answered.
struct RemoteObject::Try {
    RemoteRange* range = nullptr;  // null: the head alone
    RemoteVersion version;         // the answer to a question for the head
    std::string url, tag;
    TransferAnswer answer{};
    std::string failure;  // the last try's
    int redirects = 0;
    bool done = false;
};

bool is_unreachable(const Error& error) { return error.code() == ErrorCode::io && is_unreachable(error.what()); }

bool is_unreachable(const std::string& text) { return text.find(unreachable_text) != std::string::npos; }

bool is_replaced(const std::string& text) { return text.find(replaced_text) != std::string::npos; }

RemoteObject::RemoteObject(const std::filesystem::path& address)
    : address_(address), target_(target_of(Url::parse(address))), url_(target_.url)
{
    require_transfers(address);
}

std::optional<RemoteVersion> RemoteObject::known() const
{
    const std::lock_guard lock(mutex_);
    return version_;
}

void RemoteObject::assume(const RemoteVersion& version) const
{
    const std::lock_guard lock(mutex_);
    if (!version_) version_ = version;
}

void RemoteObject::refuse_replaced() const
{
    throw Error(ErrorCode::io, address_, replaced_text, "open the tree again when all of its files are there");
}

// The first answer says what the file is; each later one must say the same.
void RemoteObject::learn(const Try& one, std::uint64_t size) const
{
    const RemoteVersion now{one.answer.tag, one.answer.modified, size};
    const std::lock_guard lock(mutex_);
    if (!version_) version_ = now;
    if (*version_ != now) refuse_replaced();
}

// A server may send a request on to another place of its own, nowhere else: an address leads where it says.
bool RemoteObject::follow(Try& one) const
{
    const std::string to = one.answer.location;
    if (one.answer.bucket_region[0] && target_.region != one.answer.bucket_region)
        throw Error(
            ErrorCode::io, address_,
            "the bucket is in the region " + std::string(one.answer.bucket_region) + ", not in " + target_.region,
            "set AWS_REGION to it");
    const std::string server = server_of(one.url);
    const std::string url = !to.empty() && to[0] == '/' && to.rfind("//", 0) != 0 ? server + to : to;
    if (server_of(url) != server || url.empty())
        throw Error(ErrorCode::unsupported, address_,
                    "the server sends this request to another one" + (url.empty() ? "" : ", " + server_of(url)) +
                        ", and that is not followed",
                    "give the address there itself, if you trust it");
    if (++one.redirects > most_redirects)
        throw Error(ErrorCode::io, address_, "the server sends this request in circles");
    one.url = url;
    const std::lock_guard lock(mutex_);
    url_ = url;
    return false;
}

void RemoteObject::refuse(const Try& one) const
{
    const int status = one.answer.status;
    const std::string number = " (HTTP " + std::to_string(status) + ")";
    if (status == 404 || status == 410)
        throw Error(ErrorCode::not_found, address_, "the server has no such file" + number);
    if (status == 401 || status == 403)
        throw Error(ErrorCode::permission, address_, "the server does not give this file" + number,
                    target_.credentials           ? "check the keys, the region and what they permit"
                    : address_.native()[0] == 's' ? "give keys, as AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY"
                                                  : "");
    if (status == 200 && one.range)
        throw Error(ErrorCode::unsupported, address_,
                    "this server sends whole files only, and no parts of them (range requests)",
                    "use a server that does, or download the tree's folder and open that");
    throw Error(ErrorCode::io, address_, "the server's answer was not expected" + number);
}

bool RemoteObject::accept_range(Try& one) const
{
    RemoteRange& range = *one.range;
    const std::optional<StatedRange> stated = parse_range(one.answer.range);
    if (one.answer.status == 416) {
        if (!stated || !stated->empty || stated->size > range.offset) refuse(one);
        learn(one, stated->size);
        range.got = 0;
        return true;
    }
    if (!stated || stated->empty || stated->first != range.offset ||
        stated->last != std::min<std::uint64_t>(range.offset + range.bytes, stated->size) - 1 ||
        one.answer.more_than_asked || one.answer.got != stated->last - stated->first + 1) {
        one.failure = "the server sent other bytes than those that were asked for";
        return false;
    }
    learn(one, stated->size);
    range.got = static_cast<std::size_t>(one.answer.got);
    return true;
}

// Whether it is done; else it is repeated. Throws where repeating does not help.
bool RemoteObject::accept(Try& one) const
{
    const int status = one.answer.status;
    if (status != 0) {
        answered_ = true;
        gone_ = false;
    }
    if (status == 0) {
        one.failure = unreachable_text + std::string(one.answer.message);
        return false;
    }
    if (is_busy(status)) {
        one.failure = "the server is busy or does not work (HTTP " + std::to_string(status) + ")";
        return false;
    }
    if (status == 412) refuse_replaced();
    if (status >= 300 && status < 400) return follow(one);
    if (one.range && (status == 206 || status == 416)) return accept_range(one);
    if (one.range || status != 200) refuse(one);
    one.version = {one.answer.tag, one.answer.modified, one.answer.body};
    return true;
}

TransferRequest RemoteObject::request_of(const Try& one, bool new_connection) const
{
    TransferRequest request{};
    request.url = one.url.c_str();
    if (one.range) {
        request.offset = one.range->offset;
        request.bytes = one.range->bytes;
        request.to = one.range->to;
    }
    if (!one.tag.empty()) request.if_match = one.tag.c_str();
    sign(request, target_);
    request.new_connection = new_connection;
    return request;
}

// Performs what is not done yet once. The failure that makes it worth another try after a pause, if any.
const RemoteObject::Try* RemoteObject::perform_once(std::vector<Try>& tries, bool new_connections) const
{
    std::vector<Try*> open;
    std::vector<TransferRequest> requests;
    for (Try& one : tries) {
        if (one.done) continue;
        one.failure.clear();
        open.push_back(&one);
        requests.push_back(request_of(one, new_connections));
    }
    const std::vector<TransferAnswer> answers = perform_transfers(requests);
    const Try* failed = nullptr;
    for (std::size_t i = 0; i < open.size(); ++i) {
        open[i]->answer = answers[i];
        open[i]->done = accept(*open[i]);
        if (!open[i]->failure.empty() && (!failed || answers[i].retry_after > failed->answer.retry_after))
            failed = open[i];
    }
    return failed;
}

void RemoteObject::perform(std::vector<Try>& tries) const
{
    Patience patience;
    for (bool again = false;;) {
        const Try* const failed = perform_once(tries, again);
        set_network_trouble(failed ? failed->failure : std::string());
        if (std::all_of(tries.begin(), tries.end(), [](const Try& one) { return one.done; })) return;
        again = failed != nullptr;
        if (!again) continue;  // sent on by the server
        const bool silent = failed->answer.status == 0;
        const double limit = silent && gone_ ? 0 : answered_ ? most_seconds : most_seconds_of_first;
        if (!patience.wait(failed->answer.retry_after, limit)) {
            gone_ = silent;
            set_network_trouble({});
            throw Error(ErrorCode::io, address_, failed->failure, "try again later");
        }
    }
}

void RemoteObject::read(std::vector<RemoteRange>& ranges) const
{
    std::vector<Try> tries(ranges.size());
    {
        const std::lock_guard lock(mutex_);
        for (std::size_t i = 0; i < ranges.size(); ++i) {
            tries[i].range = &ranges[i];
            tries[i].url = url_;
            // A weak tag never matches; what comes is compared in any case.
            if (version_ && version_->tag.rfind("W/", 0) != 0) tries[i].tag = version_->tag;
        }
    }
    perform(tries);
}

RemoteVersion RemoteObject::ask() const
{
    std::vector<Try> tries(1);
    {
        const std::lock_guard lock(mutex_);
        tries[0].url = url_;
    }
    perform(tries);
    return tries[0].version;
}

}  // namespace pcm
