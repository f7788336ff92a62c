#include "pcm/remote/bucket_object.h"

#include "pcm/remote/remote_object.h"
#include "pcm/remote/transfers.h"
#include "pcm/system/byte_source.h"
#include "pcm/system/error.h"

#include <algorithm>

namespace pcm {
namespace {

constexpr double most_seconds = 60;
constexpr std::size_t answer_bytes = 4096;   // kept of what a server reports; an UploadId is in the first few hundred
constexpr std::uint64_t most_parts = 10000;  // S3's limit
constexpr std::size_t parts_at_once = 4;

// The text between <name> and </name>, with what XML writes for a few characters.
std::string element(const std::string& xml, const std::string& name)
{
    const std::size_t begin = xml.find("<" + name + ">");
    if (begin == std::string::npos) return {};
    const std::size_t first = begin + name.size() + 2, end = xml.find("</" + name + ">", first);
    if (end == std::string::npos) return {};
    std::string text = xml.substr(first, end - first);
    const std::pair<const char*, const char*> written[] = {
        {"&quot;", "\""}, {"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}};
    for (const auto& [code, character] : written)
        for (std::size_t at = 0; (at = text.find(code, at)) != std::string::npos; ++at)
            text.replace(at, std::string(code).size(), character);
    return text;
}

// What the server says of an error, for a message: no control characters, and not endless.
std::string said(const std::string& xml)
{
    std::string text = element(xml, "Code");
    const std::string more = element(xml, "Message");
    if (!more.empty()) text += text.empty() ? more : ": " + more;
    text = text.substr(0, 200);
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}

std::string encoded(const std::string& text)
{
    std::string out;
    for (const char c : Url{{}, {}, text}.encoded_path()) out += c == '/' ? std::string("%2F") : std::string(1, c);
    return out;
}

}  // namespace

struct BucketObject::Request {
    const char* method = "PUT";
    std::string query;  // with its '?'
    const void* content = nullptr;
    std::uint64_t bytes = 0;
    std::string url, said;
    TransferAnswer answer{};
    bool done = false;
};

// An upload in parts that has begun.
struct BucketObject::Parts {
    const ByteSource& from;
    std::uint64_t bytes, part_bytes;
    const std::function<void(std::uint64_t)>& sent;
    std::string query;              // names the upload
    std::vector<std::string> tags;  // ETag of each part; empty: not sent yet
};

BucketObject::BucketObject(const std::filesystem::path& address) : address_(address)
{
    const Url url = Url::parse(address);
    if (url.scheme != "s3") refuse_to_write(address);
    target_ = target_of(url);
    require_transfers(address);
}

void BucketObject::refuse(const Request& request) const
{
    const TransferAnswer& answer = request.answer;
    const std::string text = said(request.said);
    const std::string what = " (HTTP " + std::to_string(answer.status) + (text.empty() ? ")" : ", " + text + ")");
    if (answer.bucket_region[0] && target_.region != answer.bucket_region)
        throw Error(ErrorCode::io, address_,
                    "the bucket is in the region " + std::string(answer.bucket_region) + ", not in " + target_.region,
                    "set AWS_REGION to it");
    if (answer.status == 401 || answer.status == 403)
        throw Error(ErrorCode::permission, address_, "the server does not let this file be written" + what,
                    target_.credentials ? "check the keys, the region and what they permit"
                                        : "give keys, as AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY");
    if (answer.status == 404) throw Error(ErrorCode::not_found, address_, "the server has no such bucket" + what);
    throw Error(ErrorCode::io, address_, "the server did not take this file" + what);
}

// Whether it is done; else it is repeated.
bool BucketObject::accept(Request& request) const
{
    const int status = request.answer.status;
    const std::string code = element(request.said, "Code");
    // S3 may say that it went wrong after it has begun to answer that all is well.
    const bool wrong_within = status == 200 && !code.empty() && request.said.find("<Error>") != std::string::npos;
    if (status == 0 || is_busy(status) || wrong_within || code == "RequestTimeout" || code == "SlowDown") return false;
    if (status >= 200 && status < 300) return true;
    if (status == 404 && code != "NoSuchBucket" && std::string(request.method) != "PUT")
        return true;  // its caller knows
    refuse(request);
}

void BucketObject::perform(std::vector<Request>& requests) const
{
    Patience patience;
    for (bool again = false;; again = true) {
        std::vector<Request*> open;
        std::vector<TransferRequest> transfers;
        std::vector<std::string> bodies(requests.size(), std::string(answer_bytes, 0));
        for (Request& one : requests) {
            if (one.done) continue;
            one.url = target_.url + one.query;
            TransferRequest transfer{};
            transfer.url = one.url.c_str();
            transfer.method = one.method;
            transfer.content = one.content;
            transfer.content_bytes = one.bytes;
            transfer.to = bodies[open.size()].data();
            transfer.bytes = answer_bytes;
            sign(transfer, target_);
            transfer.new_connection = again;
            transfers.push_back(transfer);
            open.push_back(&one);
        }
        const std::vector<TransferAnswer> answers = perform_transfers(transfers);
        const Request* failed = nullptr;
        for (std::size_t i = 0; i < open.size(); ++i) {
            open[i]->answer = answers[i];
            open[i]->said = bodies[i].substr(0, static_cast<std::size_t>(answers[i].got));
            open[i]->done = accept(*open[i]);
            if (!open[i]->done) failed = open[i];
        }
        if (!failed) return;
        if (patience.wait(failed->answer.retry_after, most_seconds)) continue;
        if (failed->answer.status == 0)
            throw Error(ErrorCode::io, address_, unreachable_text + std::string(failed->answer.message),
                        "try again later");
        refuse(*failed);
    }
}

void BucketObject::write(const std::vector<std::byte>& content) const
{
    std::vector<Request> requests(1);
    requests[0].content = content.data();
    requests[0].bytes = content.size();
    perform(requests);
    check_size(content.size());
}

// What the server has now.
void BucketObject::check_size(std::uint64_t bytes) const
{
    const std::uint64_t there = RemoteObject(address_).ask().size;
    if (there != bytes)
        throw Error(
            ErrorCode::io, address_,
            "the server has " + std::to_string(there) + " of the " + std::to_string(bytes) + " bytes that were sent",
            "send it again");
}

void BucketObject::send_parts(Parts& parts) const
{
    const std::uint64_t count = (parts.bytes + parts.part_bytes - 1) / parts.part_bytes;
    parts.tags.resize(static_cast<std::size_t>(count));
    std::vector<std::vector<std::byte>> contents(parts_at_once);
    for (std::uint64_t begin = 0; begin < count; begin += parts_at_once) {
        std::vector<Request> requests(static_cast<std::size_t>(std::min<std::uint64_t>(parts_at_once, count - begin)));
        for (std::size_t i = 0; i < requests.size(); ++i) {
            const std::uint64_t at = (begin + i) * parts.part_bytes;
            contents[i].resize(static_cast<std::size_t>(std::min(parts.part_bytes, parts.bytes - at)));
            parts.from.read_at(contents[i].data(), contents[i].size(), at);
            requests[i].query = "?partNumber=" + std::to_string(begin + i + 1) + "&" + parts.query;
            requests[i].content = contents[i].data();
            requests[i].bytes = contents[i].size();
        }
        perform(requests);
        for (std::size_t i = 0; i < requests.size(); ++i) {
            if (requests[i].answer.tag[0] == 0) refuse(requests[i]);
            parts.tags[static_cast<std::size_t>(begin) + i] = requests[i].answer.tag;
        }
        if (parts.sent) parts.sent(std::min((begin + requests.size()) * parts.part_bytes, parts.bytes));
    }
}

void BucketObject::complete(const Parts& parts) const
{
    std::string list = "<CompleteMultipartUpload>";
    for (std::size_t i = 0; i < parts.tags.size(); ++i) {
        list += "<Part><PartNumber>" + std::to_string(i + 1) + "</PartNumber><ETag>";
        for (const char c : parts.tags[i]) list += c == '"' ? std::string("&quot;") : std::string(1, c);
        list += "</ETag></Part>";
    }
    list += "</CompleteMultipartUpload>";
    std::vector<Request> requests(1);
    requests[0].method = "POST";
    requests[0].query = "?" + parts.query;
    requests[0].content = list.data();
    requests[0].bytes = list.size();
    // Not found: an earlier try was carried out, and its answer was lost, if the size is right.
    perform(requests);
    check_size(parts.bytes);
}

// What names an upload in parts that begins.
std::string BucketObject::begin() const
{
    std::vector<Request> requests(1);
    requests[0].method = "POST";
    requests[0].query = "?uploads=";
    perform(requests);
    const std::string id = element(requests[0].said, "UploadId");
    if (requests[0].answer.status == 404 || id.empty()) refuse(requests[0]);
    return "uploadId=" + encoded(id);
}

void BucketObject::give_up(const std::string& query) const
{
    std::vector<Request> requests(1);
    requests[0].method = "DELETE";
    requests[0].query = "?" + query;
    perform(requests);
}

void BucketObject::check_writable() const { give_up(begin()); }

void BucketObject::write(const ByteSource& from, std::uint64_t bytes,
                         const std::function<void(std::uint64_t)>& sent) const
{
    if (bytes <= least_part_bytes) {
        std::vector<std::byte> content(static_cast<std::size_t>(bytes));
        from.read_at(content.data(), content.size(), 0);
        write(content);
        if (sent) sent(bytes);
        return;
    }
    const std::uint64_t mebibyte = std::uint64_t(1) << 20;
    const std::uint64_t wanted = (bytes / (most_parts - 1) / mebibyte + 1) * mebibyte;
    Parts parts{from, bytes, std::max(least_part_bytes, wanted), sent, begin(), {}};
    try {
        send_parts(parts);
        complete(parts);
    } catch (...) {
        try {
            give_up(parts.query);
        } catch (const Error&) {
            // The first error is the one to show; the bucket's owner sees unfinished uploads in its list of them.
        }
        throw;
    }
}

void BucketObject::remove() const
{
    std::vector<Request> requests(1);
    requests[0].method = "DELETE";
    perform(requests);
}

}  // namespace pcm
