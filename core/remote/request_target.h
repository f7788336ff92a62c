// Where the requests for an address go, and how they are signed.
#pragma once

#include "pcm/system/url.h"

#include <optional>
#include <string>

namespace pcm {

struct S3Credentials {
    std::string key_id, secret, session_token;  // the token is empty for keys that last
};

struct RequestTarget {
    std::string url;  // http or https, encoded
    std::string region;
    std::optional<S3Credentials> credentials;  // none: requests are not signed
};

// The server, the region and the keys of an s3 address are those of the usual environment variables
// (AWS_ENDPOINT_URL_S3, AWS_ENDPOINT_URL, AWS_REGION, AWS_DEFAULT_REGION, AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY,
// AWS_SESSION_TOKEN, AWS_PROFILE) or else of the files that they name (AWS_CONFIG_FILE, AWS_SHARED_CREDENTIALS_FILE;
// ~/.aws/config and
// ~/.aws/credentials). Without keys, requests are not signed, as public buckets take them. A server of AWS_ENDPOINT_URL
// has buckets in its paths. Throws Error(invalid_argument) for half of a pair of keys and for a server that is no
// http address.
RequestTarget target_of(const Url& url);

}  // namespace pcm
