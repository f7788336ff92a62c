#include "pcm/remote/block_folder.h"

#include "pcm/bpc/checksum.h"
#include "pcm/system/environment.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"

#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr char magic[8] = {'P', 'C', 'M', 'B', 'L', 'O', 'C', 'K'};
constexpr std::uint64_t default_bytes = std::uint64_t{4} << 30;
constexpr double kept_share = 0.9;  // share of the bound that stays when room is made

// Before the key, the checksum of what follows the key, and that.
struct Head {
    char magic[8];
    std::uint64_t checksum, key_bytes, bytes;
};

fs::path folder_of_user()
{
    if (const std::string named = environment("PCM_NETWORK_CACHE_FOLDER"); !named.empty()) return named;
    if (const std::string cache = environment("XDG_CACHE_HOME"); !cache.empty()) return fs::path(cache) / "pcm/network";
    if (const std::string home = environment("HOME"); !home.empty()) return fs::path(home) / ".cache/pcm/network";
    return {};
}

std::uint64_t bytes_of_user()
{
    const std::string given = environment("PCM_NETWORK_CACHE");
    if (given.empty()) return default_bytes;
    char* end = nullptr;
    const double number = std::strtod(given.c_str(), &end);
    const double unit = *end == 'G' ? 1e9 : *end == 'M' ? 1e6 : *end == 'k' ? 1e3 : 1;
    return number > 0 && number < 1e15 ? static_cast<std::uint64_t>(number * unit) : 0;
}

std::string key_of(const fs::path& address, const RemoteVersion& version, std::uint64_t block)
{
    return address.native() + '\n' + version.tag + '\n' + version.modified + '\n' + std::to_string(version.size) +
           '\n' + std::to_string(block);
}

// The file's time says when it was used last. The clock's time: the system's own is that of its last tick.
void mark_used(const File& file)
{
    timespec times[2]{};
    ::clock_gettime(CLOCK_REALTIME, &times[0]);
    times[1] = times[0];
    ::futimens(file.descriptor(), times);
}

}  // namespace

const BlockFolder& BlockFolder::of_user()
{
    static const BlockFolder folder(folder_of_user(), bytes_of_user());
    return folder;
}

BlockFolder::BlockFolder(fs::path folder, std::uint64_t most_bytes)
    : folder_(std::move(folder)), most_bytes_(folder_.empty() ? 0 : most_bytes)
{
}

fs::path BlockFolder::file_of(const std::string& key) const
{
    char name[24];
    std::snprintf(name, sizeof name, "%016llx.block",
                  static_cast<unsigned long long>(checksum(key.data(), key.size())));
    return folder_ / name;
}

std::optional<std::vector<std::byte>> BlockFolder::read_file(const std::string& key) const
{
    if (!keeps()) return std::nullopt;
    try {
        const fs::path path = file_of(key);
        std::error_code error;
        if (!fs::exists(path, error)) return std::nullopt;
        const File file(path, File::Mode::read);
        Head head{};
        file.read_at(&head, sizeof head, 0);
        if (std::memcmp(head.magic, magic, sizeof magic) != 0 || head.key_bytes != key.size() ||
            head.bytes > file.size() || file.size() != sizeof head + head.key_bytes + head.bytes)
            return std::nullopt;
        std::string of(key.size(), '\0');
        file.read_at(of.data(), of.size(), sizeof head);
        std::vector<std::byte> bytes(static_cast<std::size_t>(head.bytes));
        file.read_at(bytes.data(), bytes.size(), sizeof head + of.size());
        if (of != key || checksum(bytes.data(), bytes.size()) != head.checksum) return std::nullopt;
        mark_used(file);
        return bytes;
    } catch (const Error&) {
        return std::nullopt;
    }
}

void BlockFolder::write_file(const std::string& key, const void* bytes, std::size_t size) const
{
    if (!keeps()) return;
    try {
        std::error_code error;
        if (!fs::exists(folder_, error)) {
            fs::create_directories(folder_.parent_path(), error);
            ::mkdir(folder_.c_str(), 0700);  // what a server gives to this user is for this user
        }
        Head head{};
        std::memcpy(head.magic, magic, sizeof magic);
        head.checksum = checksum(bytes, size);
        head.key_bytes = key.size();
        head.bytes = size;
        const std::uint64_t all = sizeof head + key.size() + size;
        if (make_room(all) + all > most_bytes_) return;
        const fs::path path = file_of(key);
        File file = File::without_name(path);
        if (!file.is_open()) return;
        file.write_at(&head, sizeof head, 0);
        file.write_at(key.data(), key.size(), sizeof head);
        file.write_at(bytes, size, sizeof head + key.size());
        mark_used(file);
        if (!file.give_name(path)) {  // another version or a damaged file has the name
            ::unlink(path.c_str());
            file.give_name(path);
        }
        bytes_ += all;
    } catch (const Error&) {
        // The disk is full or may not be written: nothing is kept.
    }
}

// Removes the blocks that were used longest ago until `wanted` bytes fit; returns what is there.
std::uint64_t BlockFolder::make_room(std::uint64_t wanted) const
{
    if (counted_ && bytes_ + wanted <= most_bytes_) return bytes_;
    struct Found {
        fs::path path;
        std::uint64_t bytes = 0;
        timespec used{};
    };
    std::vector<Found> all;
    std::uint64_t sum = 0;
    std::error_code error;
    for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
        struct stat status {};
        if (it->path().extension() != ".block" || ::lstat(it->path().c_str(), &status) != 0) continue;
        all.push_back({it->path(), static_cast<std::uint64_t>(status.st_size), status.st_mtim});
        sum += all.back().bytes;
    }
    if (sum + wanted > most_bytes_) {
        std::sort(all.begin(), all.end(), [](const Found& a, const Found& b) {
            return std::pair(a.used.tv_sec, a.used.tv_nsec) < std::pair(b.used.tv_sec, b.used.tv_nsec);
        });
        const auto target = static_cast<std::uint64_t>(kept_share * static_cast<double>(most_bytes_));
        for (const Found& one : all) {
            if (sum + wanted <= target) break;
            if (::unlink(one.path.c_str()) == 0) sum -= one.bytes;
        }
    }
    bytes_ = sum;
    counted_ = true;
    return sum;
}

std::optional<std::vector<std::byte>> BlockFolder::read(const fs::path& address, const RemoteVersion& version,
                                                        std::uint64_t block) const
{
    return read_file(key_of(address, version, block));
}

void BlockFolder::write(const fs::path& address, const RemoteVersion& version, std::uint64_t block,
                        const std::vector<std::byte>& bytes) const
{
    write_file(key_of(address, version, block), bytes.data(), bytes.size());
}

// The three fields, one a line.
std::optional<RemoteVersion> BlockFolder::last_version(const fs::path& address) const
{
    const auto bytes = read_file(address.native());
    if (!bytes) return std::nullopt;
    const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    const std::size_t first = text.find('\n'), second = text.find('\n', first + 1);
    if (first == std::string::npos || second == std::string::npos) return std::nullopt;
    return RemoteVersion{text.substr(0, first), text.substr(first + 1, second - first - 1),
                         std::strtoull(text.c_str() + second + 1, nullptr, 10)};
}

void BlockFolder::remember(const fs::path& address, const RemoteVersion& version) const
{
    const std::string text = version.tag + '\n' + version.modified + '\n' + std::to_string(version.size);
    write_file(address.native(), text.data(), text.size());
}

}  // namespace pcm
