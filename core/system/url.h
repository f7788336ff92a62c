// Addresses of files behind a network, as users give them in the place of a path.
#pragma once

#include <filesystem>
#include <string>

namespace pcm {

// Whether `path` is a URL: letters and digits, a letter first, followed by "://".
bool is_url(const std::filesystem::path& path);

// Throws Error(unsupported) for a URL, in the place of what is to be written or changed.
void refuse_to_write(const std::filesystem::path& path);

struct Url {
    std::string scheme;  // http, https or s3; lower case
    std::string host;    // with a port where one is given; of s3 the bucket
    std::string path;    // from the first slash on, at least "/"; as it was given

    // Throws Error(unsupported) for another scheme, and Error(invalid_argument) for an address that has a user, a
    // password, a query or a fragment, ".." or characters that cannot be in one: what is secret does not belong into an
    // address that is shown and kept. Such errors do not repeat what may be secret.
    static Url parse(const std::filesystem::path& text);

    // The path with everything but letters, digits and "-._~/%" as %XX.
    std::string encoded_path() const;
};

}  // namespace pcm
