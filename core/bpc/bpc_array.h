// An out-of-core array of points over a BPC file, with the interface of a vector of points.
//
//   pcm::BpcArray cloud("city.bpc");
//   const auto intensity = cloud.column<std::uint16_t>("intensity");
//   for (auto point : cloud)
//       if (point.position()[2] > 100) point.set(intensity, 0);
//   cloud.flush();
//
// Cost. A point of a chunk in memory takes some nanoseconds. A point of another chunk takes reading and decoding the
// used columns of that chunk (about a millisecond per column of 100,000 points). During sequential access another
// thread decodes the next chunk. So access the points in order, or chunk by chunk, where possible. Only columns that
// are used are read. Changed columns for which memory has no room go to a scratch file, uncompressed.
#pragma once

#include "pcm/bpc/cloud_block.h"
#include "pcm/cloud/point_batch.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

namespace pcm {

struct BpcArrayOptions {
    // Limit of all that the array allocates: decoded chunks, buffers for encoding, tables of chunks (some 200 bytes per
    // chunk).
    std::size_t memory_bytes = std::size_t{256} << 20;
    // Size of the chunks that push_back() begins; 0: default_cloud_chunk_points().
    std::size_t chunk_points = 0;
    // Where changed points are kept; empty: next to the file. The scratch file has no name while it is used, so nothing
    // of it stays on disk when the process ends, also after a crash.
    std::filesystem::path scratch_folder;
    bool read_ahead = true;  // on another thread, where the memory allows it
};

// An attribute with scalars of type T, made by BpcArray::column for that array only.
template <class T>
struct BpcColumnOf {
    std::size_t attribute = 0;
    std::uint32_t components = 1;
};

template <class T>
constexpr ScalarType scalar_type_of();

// One thread at a time, also for reading, since reading loads chunks. Nothing on disk changes before flush(); the
// destructor drops changes that were not flushed. Cannot be moved: points and iterators refer to it.
class BpcArray {
    struct Resident;

public:
    class Point;
    class Iterator;

    // The cloud in a file, with a cloud block or as bare chunks (at most ChunkIndex::most_places). Throws what BpcFile
    // throws, and Error(invalid_argument) when the memory is too small for two of its chunks and the encoding of one.
    explicit BpcArray(const std::filesystem::path& path, const BpcArrayOptions& options = {});
    // An empty array that flush() writes to a file of that name. Position type, grid, schema and metadata are taken
    // from `cloud`.
    BpcArray(const std::filesystem::path& path, const BpcCloud& cloud, const BpcArrayOptions& options = {});
    ~BpcArray();
    BpcArray(const BpcArray&) = delete;
    BpcArray& operator=(const BpcArray&) = delete;

    std::uint64_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    const Schema& schema() const { return cloud_.schema; }
    // Present when positions are integers on this grid; else they are doubles.
    const std::optional<Grid>& grid() const { return cloud_.grid; }
    const std::vector<Metadata>& metadata() const { return cloud_.metadata; }

    // Indices must be less than size(). Throws Error(truncated | corrupt | io) when a chunk cannot be read, and
    // Error(no_space | io) when one cannot be spilled; then the array is unchanged, and the call may be repeated.
    Point operator[](std::uint64_t index);
    Iterator begin();
    Iterator end();

    // Exact, in source units.
    Vec3d position(std::uint64_t index);
    // On a grid the position is rounded to the nearest place; throws Error(invalid_argument) for one that is not finite
    // or needs more than 32 bits. Doubles keep every bit.
    void set_position(std::uint64_t index, const Vec3d& position);
    // Only on a grid; else Error(invalid_argument).
    std::array<std::int32_t, 3> grid_position(std::uint64_t index);
    void set_grid_position(std::uint64_t index, const std::array<std::int32_t, 3>& position);

    // Throws Error(invalid_argument), naming the existing attributes, when none has the name or its scalars are of
    // another type.
    template <class T>
    BpcColumnOf<T> column(std::string_view name) const
    {
        return {find(name, scalar_type_of<T>()), schema()[find(name, scalar_type_of<T>())].components};
    }
    template <class T>
    T get(std::uint64_t index, BpcColumnOf<T> column, std::uint32_t component = 0)
    {
        const std::byte* data = at(index, positions_ + column.attribute);
        return reinterpret_cast<const T*>(data)[(index - first_) * column.components + component];
    }
    template <class T>
    void set(std::uint64_t index, BpcColumnOf<T> column, T value, std::uint32_t component = 0)
    {
        std::byte* data = at_for_change(index, positions_ + column.attribute);
        reinterpret_cast<T*>(data)[(index - first_) * column.components + component] = value;
    }
    // A raw scalar of any type as a double (i64 and u64 beyond 2^53 are rounded).
    double value(std::uint64_t index, std::size_t attribute, std::uint32_t component = 0);

    // A new last point: 0 in every column (on a grid that is the grid's offset).
    Point push_back();
    // Appends all points of a batch. Throws Error(invalid_argument) for a batch of another shape.
    void append(const PointBatch& batch);

    // Replaces the file atomically by the array's points: a new file is written next to it, synced and renamed, so that
    // also after a crash the name refers to the old cloud or to the new one. Chunks without changes are copied as they
    // are. After an error the array and the old file are unchanged, unless it is_done(): then the new file is in place,
    // but may not survive a loss of power.
    void flush();
    // Writes the points to another file; the array keeps its own.
    void save_as(const std::filesystem::path& path);

    struct Statistics {
        std::uint64_t chunks_decoded = 0;     // on any thread
        std::uint64_t chunks_read_ahead = 0;  // chunks read ahead and then used
        std::uint64_t chunks_evicted = 0;
        std::uint64_t columns_spilled = 0;
        std::size_t most_resident_bytes = 0;  // peak size of decoded columns
    };
    const Statistics& statistics() const { return statistics_; }

private:
    static constexpr std::size_t positions_ = 3;  // columns x, y, z come before the attributes

    struct State;

    // The bytes of a column of the point's chunk, which becomes the window (first_, count_).
    std::byte* at(std::uint64_t index, std::size_t column)
    {
        if (index - first_ >= count_) open_window(index);
        std::byte* data = window_data_[column];
        return data ? data : load(column);
    }
    std::byte* at_for_change(std::uint64_t index, std::size_t column)
    {
        std::byte* data = at(index, column);
        window_changed_[column] = 1;
        return data;
    }
    void open_window(std::uint64_t index);
    std::byte* load(std::size_t column);
    std::size_t grow(std::size_t points);
    std::size_t find(std::string_view name, ScalarType type) const;

    BpcCloud cloud_;
    std::uint64_t size_ = 0;
    // The window: the most recently used chunk.
    std::uint64_t first_ = 0;
    std::uint64_t count_ = 0;
    // By column. Data is null for columns that were not used since the chunk was loaded; x, y, z count as one.
    std::byte** window_data_ = nullptr;
    std::uint8_t* window_changed_ = nullptr;
    Statistics statistics_;
    std::unique_ptr<State> state_;
};

// A reference to a point: an array and an index. Cheap to copy, valid while the array lives.
class BpcArray::Point {
public:
    Point(BpcArray& array, std::uint64_t index) : array_(&array), index_(index) {}

    std::uint64_t index() const { return index_; }
    Vec3d position() const { return array_->position(index_); }
    void set_position(const Vec3d& position) const { array_->set_position(index_, position); }
    template <class T>
    T get(BpcColumnOf<T> column, std::uint32_t component = 0) const
    {
        return array_->get(index_, column, component);
    }
    template <class T>
    void set(BpcColumnOf<T> column, std::common_type_t<T> value, std::uint32_t component = 0) const
    {
        array_->set<T>(index_, column, value, component);
    }

private:
    BpcArray* array_;
    std::uint64_t index_;
};

class BpcArray::Iterator {
public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = Point;
    using difference_type = std::int64_t;
    using pointer = void;
    using reference = Point;

    Iterator() = default;
    Iterator(BpcArray& array, std::uint64_t index) : array_(&array), index_(index) {}

    Point operator*() const { return {*array_, index_}; }
    Point operator[](difference_type n) const { return *(*this + n); }
    Iterator& operator++() { return ++index_, *this; }
    Iterator& operator--() { return --index_, *this; }
    Iterator operator++(int) { return {*array_, index_++}; }
    Iterator operator--(int) { return {*array_, index_--}; }
    Iterator& operator+=(difference_type n) { return index_ += static_cast<std::uint64_t>(n), *this; }
    Iterator& operator-=(difference_type n) { return index_ -= static_cast<std::uint64_t>(n), *this; }
    Iterator operator+(difference_type n) const { return {*array_, index_ + static_cast<std::uint64_t>(n)}; }
    Iterator operator-(difference_type n) const { return {*array_, index_ - static_cast<std::uint64_t>(n)}; }
    friend Iterator operator+(difference_type n, const Iterator& i) { return i + n; }
    difference_type operator-(const Iterator& o) const { return static_cast<difference_type>(index_ - o.index_); }
    bool operator==(const Iterator& o) const { return index_ == o.index_; }
    bool operator!=(const Iterator& o) const { return index_ != o.index_; }
    bool operator<(const Iterator& o) const { return index_ < o.index_; }
    bool operator>(const Iterator& o) const { return index_ > o.index_; }
    bool operator<=(const Iterator& o) const { return index_ <= o.index_; }
    bool operator>=(const Iterator& o) const { return index_ >= o.index_; }

private:
    BpcArray* array_ = nullptr;
    std::uint64_t index_ = 0;
};

inline BpcArray::Point BpcArray::operator[](std::uint64_t index) { return {*this, index}; }
inline BpcArray::Iterator BpcArray::begin() { return {*this, 0}; }
inline BpcArray::Iterator BpcArray::end() { return {*this, size_}; }

inline Vec3d BpcArray::position(std::uint64_t index)
{
    // The three axes are loaded together.
    const std::byte* const axes[3] = {at(index, 0), window_data_[1], window_data_[2]};
    const std::uint64_t i = index - first_;
    Vec3d position;
    if (cloud_.grid)
        for (std::size_t a = 0; a < 3; ++a)
            position[a] = cloud_.grid->to_source(reinterpret_cast<const std::int32_t*>(axes[a])[i], a);
    else
        for (std::size_t a = 0; a < 3; ++a) position[a] = reinterpret_cast<const double*>(axes[a])[i];
    return position;
}

template <class T>
constexpr ScalarType scalar_type_of()
{
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>, "scalars of points are numbers");
    if constexpr (std::is_floating_point_v<T>) {
        static_assert(sizeof(T) == 4 || sizeof(T) == 8);
        return sizeof(T) == 4 ? ScalarType::f32 : ScalarType::f64;
    } else if constexpr (std::is_signed_v<T>) {
        return sizeof(T) == 1   ? ScalarType::i8
               : sizeof(T) == 2 ? ScalarType::i16
               : sizeof(T) == 4 ? ScalarType::i32
                                : ScalarType::i64;
    } else {
        return sizeof(T) == 1   ? ScalarType::u8
               : sizeof(T) == 2 ? ScalarType::u16
               : sizeof(T) == 4 ? ScalarType::u32
                                : ScalarType::u64;
    }
}

}  // namespace pcm
