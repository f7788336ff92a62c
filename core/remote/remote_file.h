// A file behind an address, read in blocks that stay in memory and on this machine's disk for a while.
#pragma once

#include "pcm/remote/block_folder.h"
#include "pcm/remote/block_memory.h"
#include "pcm/remote/remote_object.h"
#include "pcm/system/byte_source.h"

#include <cstdint>
#include <filesystem>
#include <mutex>

namespace pcm {

// Nothing is asked of the server before the first read. Blocks that lie side by side come in one request, and the
// requests of a read are sent together. Each takes a whole round trip: a file's beginning comes with
// blocks_of_beginning, since an index and the coarse levels lie there, and reads that continue where the one before
// ended bring twice as many blocks each time, up to most_blocks_of_request. Where the server cannot be reached at the
// first read, what an earlier process left on disk is shown, and everything else throws Error(io).
class RemoteFile final : public ByteSource {
public:
    static constexpr std::uint64_t block_bytes = std::uint64_t{1} << 20;
    static constexpr std::uint64_t blocks_of_beginning = 4, most_blocks_of_request = 8;

    explicit RemoteFile(const std::filesystem::path& address, const BlockFolder& folder = BlockFolder::of_user());
    ~RemoteFile() override;

    const std::filesystem::path& path() const override { return object_.address(); }
    std::uint64_t size() const override;
    std::size_t read_some_at(void* to, std::size_t bytes, std::uint64_t offset) const override;
    bool keeps_its_name() const override;

private:
    void find_version() const;
    BlockMemory::Fetched fetch(const BlockMemory::Numbers& numbers) const;
    std::uint64_t blocks_ahead(std::uint64_t first, std::uint64_t end) const;
    std::vector<RemoteBlock> download(const std::vector<std::uint64_t>& numbers) const;

    RemoteObject object_;
    const BlockFolder& folder_;
    mutable std::once_flag asked_;
    mutable std::mutex run_mutex_;
    mutable std::uint64_t run_end_ = 0, run_blocks_ = 0;  // reads that follow each other: their end, the last request
};

}  // namespace pcm
