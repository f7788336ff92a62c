#include "pcm/remote/request_target.h"

#include "pcm/system/environment.h"
#include "pcm/system/error.h"

#include <filesystem>
#include <fstream>
#include <map>

namespace pcm {
namespace {

namespace fs = std::filesystem;

using Settings = std::map<std::string, std::string>;

std::string first_of(std::initializer_list<std::string> values)
{
    for (const std::string& value : values)
        if (!value.empty()) return value;
    return {};
}

std::string trimmed(const std::string& text)
{
    const std::size_t first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
    return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

// The lines NAME = VALUE of one section; none where there is no such file.
Settings section_of(const fs::path& file, const std::string& section)
{
    Settings settings;
    std::ifstream in(file);
    bool inside = false;
    for (std::string line; std::getline(in, line);) {
        const std::string text = trimmed(line);
        if (text.empty() || text[0] == '#' || text[0] == ';') continue;
        if (text.front() == '[') {
            inside = text == "[" + section + "]";
        } else if (const std::size_t equals = text.find('='); inside && equals != std::string::npos) {
            settings[trimmed(text.substr(0, equals))] = trimmed(text.substr(equals + 1));
        }
    }
    return settings;
}

fs::path file_of(const char* variable, const char* name)
{
    const std::string named = environment(variable);
    if (!named.empty()) return named;
    const std::string home = environment("HOME");
    return home.empty() ? fs::path() : fs::path(home) / ".aws" / name;
}

std::optional<S3Credentials> credentials_of(const std::string& profile)
{
    S3Credentials keys{environment("AWS_ACCESS_KEY_ID"), environment("AWS_SECRET_ACCESS_KEY"),
                       environment("AWS_SESSION_TOKEN")};
    std::string from = "AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY";
    if (keys.key_id.empty() && keys.secret.empty()) {
        const fs::path file = file_of("AWS_SHARED_CREDENTIALS_FILE", "credentials");
        Settings settings = section_of(file, profile);
        keys = {settings["aws_access_key_id"], settings["aws_secret_access_key"], settings["aws_session_token"]};
        from = "the section [" + profile + "] of " + file.string();
    }
    if (keys.key_id.empty() && keys.secret.empty()) return std::nullopt;
    if (keys.key_id.empty() || keys.secret.empty())
        throw Error(ErrorCode::invalid_argument, {}, from + " name one half of a pair of keys only",
                    "give both, or none");
    return keys;
}

// A server that was named has buckets in its paths, the others in their names.
std::string s3_server(const Url& url, const std::string& endpoint, const std::string& region)
{
    if (endpoint.empty()) return "https://" + url.host + ".s3." + region + ".amazonaws.com";
    const Url server = is_url(endpoint) ? Url::parse(endpoint) : Url();
    if (server.scheme != "http" && server.scheme != "https")
        throw Error(ErrorCode::invalid_argument, {},
                    "AWS_ENDPOINT_URL is not an address that begins with https:// or http://");
    std::string path = server.encoded_path();
    while (!path.empty() && path.back() == '/') path.pop_back();
    return server.scheme + "://" + server.host + path + "/" + url.host;
}

}  // namespace

RequestTarget target_of(const Url& url)
{
    if (url.scheme != "s3") return {url.scheme + "://" + url.host + url.encoded_path(), {}, std::nullopt};
    const std::string profile = first_of({environment("AWS_PROFILE"), "default"});
    Settings config =
        section_of(file_of("AWS_CONFIG_FILE", "config"), profile == "default" ? profile : "profile " + profile);
    RequestTarget target;
    target.region =
        first_of({environment("AWS_REGION"), environment("AWS_DEFAULT_REGION"), config["region"], "us-east-1"});
    const std::string endpoint =
        first_of({environment("AWS_ENDPOINT_URL_S3"), environment("AWS_ENDPOINT_URL"), config["endpoint_url"]});
    target.url = s3_server(url, endpoint, target.region) + url.encoded_path();
    target.credentials = credentials_of(profile);
    return target;
}

}  // namespace pcm
