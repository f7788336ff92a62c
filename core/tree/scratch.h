// The builder's scratch file: rows of points, sorted into bins, on disk.
#pragma once

#include "cloud/file.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <vector>

namespace pcm {

// Any number of Writers, one a thread, append to the bins; reading starts when they are flushed.
class Scratch {
public:
    Scratch(const std::filesystem::path& path, std::size_t row_bytes);
    ~Scratch();  // removes the file

    std::size_t row_bytes() const { return row_bytes_; }
    std::size_t bins() const { return bins_.size(); }
    std::size_t add_bins(std::size_t count);  // returns the number of the first new one
    std::uint64_t rows(std::size_t bin) const { return bins_[bin].rows; }

    class Writer {
    public:
        // Buffers `buffer_bytes` in all, shared by bins [first_bin, first_bin + bins).
        Writer(Scratch& scratch, std::size_t first_bin, std::size_t bins, std::size_t buffer_bytes);
        void add(std::size_t bin, const std::byte* row);
        void flush();

    private:
        void flush(std::size_t slot);
        Scratch& scratch_;
        std::size_t first_bin_;
        std::size_t rows_each_;
        std::vector<std::byte> buffer_;
        std::vector<std::uint32_t> filled_;
    };

    // Appends `count` rows straight to a bin. Threads may call it for any bins.
    void append(std::size_t bin, const std::byte* rows, std::size_t count);

    // Blocks of a bin, in no particular order; each is read with read_block.
    std::size_t blocks(std::size_t bin) const { return bins_[bin].blocks.size(); }
    std::size_t block_rows(std::size_t bin, std::size_t block) const { return bins_[bin].blocks[block].rows; }
    void read_block(std::size_t bin, std::size_t block, std::byte* to) const;
    std::vector<std::byte> read(std::size_t bin) const;
    // Replaces all rows of a bin; as many as it has.
    void rewrite(std::size_t bin, const std::byte* rows);
    void forget(std::size_t bin);  // the bin is empty from now on; its space on disk stays

private:
    struct Block {
        std::uint64_t offset;
        std::uint32_t rows;
    };
    struct Bin {
        std::vector<Block> blocks;
        std::uint64_t rows = 0;
    };
    File file_;
    std::size_t row_bytes_;
    std::vector<Bin> bins_;
    std::mutex mutex_;
    std::uint64_t end_ = 0;
};

}  // namespace pcm
