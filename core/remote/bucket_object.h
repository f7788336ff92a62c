// One file in a bucket (s3://BUCKET/PATH), written or removed. Reading is remote_object.h.
//
// Requests that get no answer, or come while the server is busy, are repeated for up to a minute. The checksum of all
// that is sent is part of the signature: what the server has taken is what was sent.
#pragma once

#include "pcm/remote/request_target.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace pcm {

class ByteSource;

class BucketObject {
public:
    // Throws what target_of() throws; Error(unsupported) where the module with libcurl is not here, and for addresses
    // that are not s3: nothing is written to those.
    explicit BucketObject(const std::filesystem::path& address);

    // The following throw Error(not_found) where there is no such bucket, Error(permission) and Error(io); each names
    // the address and what the server reports.

    // Whether writing is permitted: begins an upload, and gives it up.
    void check_writable() const;

    // All at once: for what is small.
    void write(const std::vector<std::byte>& content) const;

    // The first `bytes` of `from`, which it has, in parts (S3's multipart upload): the file appears when it is
    // complete, and what was sent is removed when it fails or `sent` throws. `sent` gets the bytes sent so far, after
    // each group of parts.
    void write(const ByteSource& from, std::uint64_t bytes, const std::function<void(std::uint64_t)>& sent) const;

    // Also where there is no such file.
    void remove() const;

    static constexpr std::uint64_t least_part_bytes = std::uint64_t(8) << 20;  // S3 takes no smaller ones than 5 MiB

private:
    struct Request;
    struct Parts;
    void perform(std::vector<Request>& requests) const;
    bool accept(Request& request) const;
    [[noreturn]] void refuse(const Request& request) const;
    void check_size(std::uint64_t bytes) const;
    void send_parts(Parts& parts) const;
    void complete(const Parts& parts) const;
    std::string begin() const;
    void give_up(const std::string& query) const;

    std::filesystem::path address_;
    RequestTarget target_;
};

}  // namespace pcm
