// The interface between the library and the shared object with libcurl in it, which is loaded when the first address is
// opened: core builds and runs without libcurl (Debian: libcurl4-openssl-dev; licence: curl's own, like MIT).
//
// It only carries requests: what is asked, retried, followed or refused is decided in remote/.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcm {

// Texts end with a zero byte; null where there is none.
struct TransferRequest {
    const char* url;
    std::uint64_t offset, bytes;  // the range that is asked for; of no bytes: the answer's head alone (HEAD)
    void* to;                     // room for `bytes`
    const char* if_match;         // entity tag, quotes included
    // Where there is a method (PUT, POST, DELETE) the `content` is sent with it, no range is asked for, and `to` takes
    // what it has room for of the answer, whatever its status.
    const char* method;
    const void* content;
    std::uint64_t content_bytes;
    // For a signed request, as S3 asks for it (AWS signature version 4).
    const char *region, *key_id, *secret, *session_token;
    bool new_connection;  // not one that was used before
};

struct TransferAnswer {
    int status;            // HTTP's; 0: there was no answer, and `message` says why
    bool more_than_asked;  // the body was longer than the range; it was cut off
    std::uint64_t got;     // bytes of the body that were stored
    std::uint64_t body;    // length of the body as the server states it; of HEAD, the length of the file
    double retry_after;    // seconds; 0 when the server does not say
    char tag[256];         // header lines without their names; empty: none, or longer than there is room
    char modified[64];
    char range[96];  // Content-Range
    char location[1024];
    char bucket_region[64];  // x-amz-bucket-region
    char message[256];
};

struct TransferOptions {
    double connect_seconds;    // the longest wait for a connection
    double stall_seconds;      // and for the next byte
    int connections;           // at most, to one server
    const char* certificates;  // a file of certificates to trust, or null for the system's
};

// A session keeps its connections; any number of threads may call perform() on one.
struct TransferFunctions {
    std::uint32_t version;
    void* (*open)(const TransferOptions* options);  // null: it cannot be made
    void (*close)(void* session);                   // when no thread is in perform()
    // Returns when all are answered.
    void (*perform)(void* session, const TransferRequest* requests, TransferAnswer* answers, std::size_t count);
};

inline constexpr std::uint32_t curl_module_version = 2;

// The one symbol of the shared object: see system/shared_module.h.
inline constexpr const char* curl_module_symbol = "pcm_transfer_functions";

}  // namespace pcm
