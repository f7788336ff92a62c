#include "pcm/remote/transfers.h"

#include "pcm/system/error.h"
#include "pcm/system/seconds.h"
#include "pcm/system/shared_module.h"
#include "pcm/system/work_done.h"

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <random>
#include <thread>

namespace pcm {
namespace {

constexpr const char* module_file = "libpcm_curl.so";
constexpr double longest_wait = 5;  // seconds between two tries

struct Session {
    const TransferFunctions* functions = nullptr;
    void* session = nullptr;
    std::string missing;
};

// One for the process; it stays until the process ends, since its connections serve all trees.
const Session& session()
{
    static const Session opened = [] {
        const SharedModule module = load_shared_module(module_file, curl_module_symbol, curl_module_version);
        Session made{static_cast<const TransferFunctions*>(module.functions), nullptr, module.missing};
        if (!made.functions) return made;
        TransferOptions options{};
        options.connect_seconds = 5;
        options.stall_seconds = 10;
        options.connections = 16;
        options.certificates = std::getenv("SSL_CERT_FILE");
        made.session = made.functions->open(&options);
        if (!made.session) made.missing = "libcurl cannot be started";
        return made;
    }();
    return opened;
}

}  // namespace

void require_transfers(const std::filesystem::path& address)
{
    if (!session().session)
        throw Error(
            ErrorCode::unsupported, address, "addresses cannot be opened here: " + session().missing,
            std::string("install ") + module_file +
                " (Debian's package pcmlab has it; built where libcurl4-openssl-dev is installed), and libcurl");
}

std::vector<TransferAnswer> perform_transfers(const std::vector<TransferRequest>& requests)
{
    std::vector<TransferAnswer> answers(requests.size());
    session().functions->perform(session().session, requests.data(), answers.data(), requests.size());
    for (const TransferAnswer& answer : answers) count_request(answer.got);
    return answers;
}

void sign(TransferRequest& request, const RequestTarget& target)
{
    request.region = target.region.c_str();
    if (!target.credentials) return;
    request.key_id = target.credentials->key_id.c_str();
    request.secret = target.credentials->secret.c_str();
    if (!target.credentials->session_token.empty()) request.session_token = target.credentials->session_token.c_str();
}

bool is_busy(int status) { return status == 408 || status == 429 || (status >= 500 && status != 501 && status != 505); }

bool Patience::wait(double retry_after, double most_seconds)
{
    thread_local std::minstd_rand random{std::random_device{}()};
    const double pause = std::max(retry_after, next_ * std::uniform_real_distribution<>(0.5, 1.0)(random));
    const double gone = seconds_since(start_);
    if (!(gone + pause < most_seconds)) return false;
    std::this_thread::sleep_for(std::chrono::duration<double>(pause));
    next_ = std::min(2 * next_, longest_wait);
    return true;
}

namespace {

std::mutex trouble_mutex;
std::string trouble;

}  // namespace

std::string network_trouble()
{
    const std::lock_guard lock(trouble_mutex);
    return trouble;
}

void set_network_trouble(const std::string& text)
{
    const std::lock_guard lock(trouble_mutex);
    trouble = text;
}

}  // namespace pcm
