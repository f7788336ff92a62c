// Rows of a cloud that can only be read in order, packed on disk until the bins are known.
#pragma once

#include "pcm/bpc/double_codes.h"
#include "pcm/build/bins/row_packing.h"
#include "pcm/build/bins/scratch_file.h"

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

class Spool {
public:
    // Rows of this layout; `doubles`: the layout is wide and positions are doubles, which keep their bits.
    Spool(const std::filesystem::path& path, const RowLayout& layout, const Schema& schema, bool doubles,
          ScratchSpace& space);
    // Reopens a file that was kept, as it was when save() wrote `in`.
    Spool(const std::filesystem::path& path, const RowLayout& layout, const Schema& schema, bool doubles,
          ScratchSpace& space, ByteReader& in);
    ~Spool()
    {
        if (!kept_) file_.remove();
    }

    // The file stays. To be called when all writers have ended, like save().
    void keep() { kept_ = true; }
    void save(ByteWriter& out) const;
    std::uint64_t bytes() const { return file_.bytes(); }

    std::size_t row_bytes() const { return row_bytes_; }
    std::uint64_t rows() const { return rows_; }

    // Belongs to one thread.
    class Writer {
    public:
        explicit Writer(Spool& spool) : spool_(spool) {}
        // Writes `count` rows as one block. Overwrites their positions when they are doubles.
        void append(std::byte* rows, std::size_t count);

    private:
        void code_doubles_of(std::byte* rows, std::size_t count, DoubleCodes& codes);
        Spool& spool_;
        Vec3d divisor_{0, 0, 0};  // divisor of the block before: likely that of the next one too
        std::vector<std::byte> packed_;
        std::vector<double> values_;
        std::vector<std::int64_t> coded_;
    };

    // Blocks in no particular order. read() appends a block's rows. Throws Error(corrupt) when the bytes have changed
    // since they were written.
    std::size_t pieces() const { return blocks_.size(); }
    void read(std::size_t piece, std::vector<std::byte>& rows) const;
    // Releases the disk space of a block.
    void give_back(std::size_t piece);

private:
    struct Block {
        std::uint64_t offset, bytes, rows, checksum;
        DoubleCodes codes;
    };
    ScratchFile file_;
    const std::size_t row_bytes_;
    const bool doubles_;
    const RowPacking packing_;
    std::mutex mutex_;
    std::vector<Block> blocks_;
    std::uint64_t rows_ = 0;
    bool kept_ = false;
};

}  // namespace pcm
