// The builder's scratch file: rows of points, sorted into bins, packed, on disk.
//
// A bin lies in extents: ranges of the file that belong to it alone, large enough to be read in few pieces and to be
// released. An extent is a sequence of packed blocks of rows.
#pragma once

#include "pcm/build/bins/row_packing.h"
#include "pcm/build/bins/scratch_file.h"

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <utility>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

// Any number of Writers, one per thread, append to the bins; reading starts when they are flushed.
class Scratch {
public:
    Scratch(const std::filesystem::path& path, const RowLayout& layout, const Schema& schema, ScratchSpace& space);
    // Reopens the file as it was when save() wrote `in`.
    Scratch(const std::filesystem::path& path, const RowLayout& layout, const Schema& schema, ScratchSpace& space,
            ByteReader& in);
    void save(ByteWriter& out) const;
    // One bin as save() writes it.
    void save(std::size_t bin, ByteWriter& out) const;
    std::uint64_t bytes() const { return file_.bytes(); }  // end of the last extent

    std::size_t row_bytes() const { return row_bytes_; }
    std::size_t bins() const { return bins_.size(); }
    std::size_t add_bins(std::size_t count);  // returns the number of the first new one
    std::uint64_t rows(std::size_t bin) const { return bins_[bin].rows; }

    struct Work {  // a thread's own
        std::vector<std::byte> packed;
        std::vector<std::uint32_t> order;
        std::vector<std::uint16_t> cells;
    };
    class Writer {
    public:
        // Buffers `buffer_bytes` in all, shared by bins [first_bin, first_bin + bins).
        // `buffer`: the memory of an earlier one, which need not be cleared by the system again.
        Writer(Scratch& scratch, std::size_t first_bin, std::size_t bins, std::size_t buffer_bytes,
               std::vector<std::byte> buffer = {});
        void add(std::size_t bin, const std::byte* row);
        // The same for rows that follow one another.
        void add(const std::uint32_t* bins, const std::byte* rows, std::size_t count);
        void flush();
        // After flush(), at last: the memory of the buffers.
        std::vector<std::byte> take_buffer() { return std::move(buffer_); }

    private:
        void flush(std::size_t slot);
        Scratch& scratch_;
        std::size_t first_bin_;
        std::size_t rows_each_;
        std::vector<std::byte> buffer_;
        std::vector<std::uint32_t> filled_;
        Work work_;
    };

    // Appends `count` rows directly to a bin, in any order. Any thread, any bin.
    void append(std::size_t bin, const std::byte* rows, std::size_t count, Work& work);

    // Extents of a bin, in no particular order. read() appends an extent's rows to `rows`. Throws Error(corrupt) when
    // the bytes have changed since they were written.
    std::size_t extents(std::size_t bin) const { return bins_[bin].extents.size(); }
    void read(std::size_t bin, std::size_t extent, std::vector<std::byte>& rows) const;
    std::vector<std::byte> read(std::size_t bin) const;

    // Releases the disk space of an extent, or of all of a bin's, where the file system can. The bin keeps its number
    // of rows.
    void give_back(std::size_t bin, std::size_t extent);
    void give_back(std::size_t bin);
    // Makes a bin empty whose space has been released.
    void forget(std::size_t bin);

    void sync() { file_.sync(); }
    // Whether the file is long enough to hold the bin.
    bool can_hold(std::size_t bin) const;
    void clear() { file_.clear(); }  // makes the file empty

private:
    struct Extent {
        std::uint64_t offset;
        std::uint32_t room, used, rows;
    };
    struct Bin {
        std::vector<Extent> extents;
        std::uint64_t rows = 0;
    };
    ScratchFile file_;
    const std::size_t row_bytes_, coordinate_bytes_;
    const RowPacking packing_;
    std::vector<Bin> bins_;
    std::mutex mutex_;
};

}  // namespace pcm
