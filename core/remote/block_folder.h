// Blocks of files behind addresses, kept on this machine's disk for the next time: a bounded folder that all processes
// of one user share.
//
// A block is a file that names what it is of and has a checksum; what is not as it should be counts as absent. Files
// are put in place whole, so that any number of processes may read, write and remove at once. Nothing throws: a cache
// that does not work counts as empty.
#pragma once

#include "pcm/remote/remote_object.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

class BlockFolder {
public:
    // The folder of the user, $PCM_NETWORK_CACHE_FOLDER or else $XDG_CACHE_HOME/pcm/network, with at most
    // $PCM_NETWORK_CACHE bytes ("4G" by default; "0": nothing is kept).
    static const BlockFolder& of_user();

    // At most `most_bytes` stay, but for what other processes write just now. The folder is made when it is needed.
    BlockFolder(std::filesystem::path folder, std::uint64_t most_bytes);

    bool keeps() const { return most_bytes_ > 0; }
    std::optional<std::vector<std::byte>> read(const std::filesystem::path& address, const RemoteVersion& version,
                                               std::uint64_t block) const;
    void write(const std::filesystem::path& address, const RemoteVersion& version, std::uint64_t block,
               const std::vector<std::byte>& bytes) const;

    // The version whose blocks were written last.
    std::optional<RemoteVersion> last_version(const std::filesystem::path& address) const;
    void remember(const std::filesystem::path& address, const RemoteVersion& version) const;

private:
    std::optional<std::vector<std::byte>> read_file(const std::string& key) const;
    void write_file(const std::string& key, const void* bytes, std::size_t size) const;
    std::filesystem::path file_of(const std::string& key) const;
    std::uint64_t make_room(std::uint64_t wanted) const;

    std::filesystem::path folder_;
    std::uint64_t most_bytes_;
    mutable std::atomic<std::uint64_t> bytes_{0};  // all files when they were counted last, and those written since
    mutable std::atomic<bool> counted_{false};
};

}  // namespace pcm
