// Where the rows of bins lie, in the scratch files of many jobs.
#pragma once

#include "pcm/build/bins/bins.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

class BinRows {
public:
    struct Piece {
        std::uint32_t file = 0;
        std::uint64_t rows = 0;
        std::vector<std::byte> place;  // as Scratch::save() writes it for a bin
    };

    explicit BinRows(const Ingested& cloud) : cloud_(cloud) {}

    std::size_t bins() const { return bins_.size(); }
    std::size_t add_bins(std::size_t count);  // returns the number of the first
    std::uint64_t rows(std::size_t bin) const { return bins_[bin].rows; }
    std::uint32_t add_file(std::filesystem::path path);  // returns its number
    void add(std::size_t bin, Piece piece);
    void forget(std::size_t bin) { bins_[bin] = Bin(); }

    // All rows of a bin; or, piece by piece, take(rows). Any thread.
    std::vector<std::byte> read(std::size_t bin) const;
    template <class Take>
    void read(std::size_t bin, const Take& take) const
    {
        for (const Piece& piece : bins_[bin].pieces) {
            const std::unique_ptr<Scratch> scratch = open(piece);
            std::vector<std::byte> rows;
            for (std::size_t e = 0; e < scratch->extents(0); ++e) {
                rows.clear();
                scratch->read(0, e, rows);
                take(rows);
            }
        }
    }

    // The bins of a scratch file that have rows, as pieces; and the reverse, with the number of the file.
    static void save(const Scratch& scratch, ByteWriter& out);
    static std::vector<std::pair<std::size_t, Piece>> load(ByteReader& in, std::uint32_t file);

private:
    struct Bin {
        std::vector<Piece> pieces;
        std::uint64_t rows = 0;
    };
    std::unique_ptr<Scratch> open(const Piece& piece) const;

    const Ingested& cloud_;
    mutable ScratchSpace counted_;  // room that the files take, counted where they were written
    std::vector<std::filesystem::path> files_;
    std::vector<Bin> bins_;
};

}  // namespace pcm
