// Positions of the bins of a build, in Morton order, packed on disk: what sampling reads repeatedly.
#pragma once

#include "pcm/build/levels/lattice.h"
#include "pcm/system/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

inline constexpr std::size_t sorted_block = 1024;  // points that are packed together, and read together

// Opens the file of a bin, where each has its own. Any thread.
using OpenBin = std::function<File(std::size_t bin)>;

template <class Coord>
class SortedPoints {
public:
    explicit SortedPoints(const std::filesystem::path& path);
    ~SortedPoints();  // removes the file
    // A file that stays. With Mode::change it is an existing one, and load() says where each bin lies.
    SortedPoints(const std::filesystem::path& path, File::Mode mode);
    // Bins with a file each, which begins with what packed() returned.
    explicit SortedPoints(OpenBin open);

    struct Box {
        Point<Coord> low{}, high{};
        std::uint64_t points = 0;
    };

    void resize(std::size_t bins) { bins_.resize(bins); }
    std::size_t bins() const { return bins_.size(); }
    const Box& box(std::size_t bin) const { return bins_[bin].box; }
    // Bytes on disk so far.
    std::uint64_t bytes() const { return end_; }

    // Any thread, each bin once. `points` in Morton order, at least one. Returns the bytes they take on disk.
    std::uint64_t put(std::size_t bin, const std::vector<Point<Coord>>& points);
    // The bytes that a bin takes, where each has a file of its own; sets its box and its places. As put() otherwise.
    std::vector<std::byte> packed(std::size_t bin, const std::vector<Point<Coord>>& points);
    // A bin's box alone: enough for bins whose points are not read.
    void set_box(std::size_t bin, const Box& box) { bins_[bin].box = box; }
    // Where a bin lies, and the reverse. load() throws Error(corrupt) when it does not lie within the file.
    void save(std::size_t bin, ByteWriter& out) const;
    void load(std::size_t bin, ByteReader& in);
    void sync() { file_.sync(); }

    // A bin's points, read block by block on access. Belongs to one thread.
    class Reader {
    public:
        Reader(const SortedPoints& store, std::size_t bin);
        std::size_t size() const { return size_; }
        const Point<Coord>& operator[](std::size_t i)
        {
            if (!ready_[i / sorted_block]) load(i / sorted_block);
            return points_[i];
        }
        // The end of the run of points, from `i` on and before `end`, that share i's cell.
        std::size_t end_of_cell(std::size_t i, std::size_t end, const std::array<int, 3>& shifts)
        {
            const std::size_t next = i + 1;
            if (next == end) return end;
            if (next % sorted_block && ready_[i / sorted_block] && !same_cell(points_[i], points_[next], shifts))
                return next;
            return end_of_longer_cell(i, end, shifts);
        }

    private:
        void load(std::size_t block);
        std::size_t end_of_longer_cell(std::size_t i, std::size_t end, const std::array<int, 3>& shifts);
        const SortedPoints& store_;
        const File own_;  // the bin's, where each has its own
        const File& file_;
        std::size_t bin_;
        std::size_t size_;
        std::unique_ptr<Point<Coord>[]> points_;  // points of blocks that are ready
        std::vector<std::uint8_t> ready_;
        std::vector<std::byte> bytes_;
        std::vector<Coord> words_;
    };

private:
    struct Block {
        std::uint64_t offset;
        std::uint32_t bytes;
        std::uint32_t check;  // low bits of the checksum
        Point<Coord> first;
    };
    struct Bin {
        Box box;
        std::vector<Block> blocks;
    };
    const OpenBin open_;  // empty: all are in file_
    File file_;
    const bool remove_;
    std::vector<Bin> bins_;
    std::mutex mutex_;
    std::uint64_t end_ = 0;
};

extern template class SortedPoints<std::uint32_t>;
extern template class SortedPoints<std::uint64_t>;

}  // namespace pcm
