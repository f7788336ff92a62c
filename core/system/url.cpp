#include "pcm/system/url.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string_view>

namespace pcm {
namespace {

constexpr const char* separator = "://";

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) && static_cast<unsigned char>(c) < 128; }
bool is_letter_or_digit(char c) { return is_letter(c) || (c >= '0' && c <= '9'); }
bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }
bool is_in_host(char c)
{
    return is_letter_or_digit(c) || std::string_view("-._:[]").find(c) != std::string_view::npos;
}

[[noreturn]] void refuse(const std::string& shown, const std::string& what, const std::string& hint)
{
    throw Error(ErrorCode::invalid_argument, shown, what, hint);
}

}  // namespace

void refuse_to_write(const std::filesystem::path& path)
{
    if (is_url(path))
        throw Error(ErrorCode::unsupported, path,
                    "nothing is written to an address, except trees to buckets (s3://) by build and convert",
                    "write to a path of this machine ('pcmlab convert ADDRESS COPY.pct' copies a tree to one)");
}

bool is_url(const std::filesystem::path& path)
{
    const std::string& text = path.native();
    const std::size_t end = text.find(separator);
    return end != std::string::npos && end > 0 && is_letter(text[0]) &&
           std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), is_letter_or_digit);
}

Url Url::parse(const std::filesystem::path& text)
{
    const std::string& all = text.native();
    const std::size_t end = all.find(separator);
    if (!is_url(text)) refuse(all, "this is not an address: it does not begin with https://, http:// or s3://", {});
    Url url;
    for (const char c : all.substr(0, end))
        url.scheme += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (url.scheme != "http" && url.scheme != "https" && url.scheme != "s3")
        throw Error(ErrorCode::unsupported, url.scheme + separator,
                    "addresses of this kind cannot be read; https, http and s3 can");
    const std::size_t host = end + std::strlen(separator), slash = std::min(all.find('/', host), all.size());
    url.host = all.substr(host, slash - host);
    url.path = slash < all.size() ? all.substr(slash) : "/";
    if (url.host.find('@') != std::string::npos)
        refuse(url.scheme + separator,
               "an address with a user or a password in it is not taken: it would be shown and kept",
               "put credentials where the README says, and leave them out of the address");
    if (url.host.empty()) refuse(all, "the address names no server", {});
    if (!std::all_of(url.host.begin(), url.host.end(), is_in_host))
        refuse(url.scheme + separator, "the name of the server has characters that no server's name has", {});
    if (const std::size_t mark = url.path.find_first_of("?#"); mark != std::string::npos)
        refuse(url.scheme + separator + url.host + url.path.substr(0, mark),
               std::string("the address has a '") + url.path[mark] + "', and trees are several files below one address",
               "leave out what begins there");
    if (std::any_of(url.path.begin(), url.path.end(), is_control) || (url.path + "/").find("/../") != std::string::npos)
        refuse(url.scheme + separator + url.host, "the address has '..' or characters that cannot be in one", {});
    return url;
}

std::string Url::encoded_path() const
{
    static constexpr char digits[] = "0123456789ABCDEF";
    std::string out;
    for (const char c : path) {
        if (is_letter_or_digit(c) || std::string_view("-._~/%").find(c) != std::string_view::npos) {
            out += c;
        } else {
            const auto byte = static_cast<unsigned char>(c);
            out += {'%', digits[byte >> 4], digits[byte & 15]};
        }
    }
    return out;
}

}  // namespace pcm
