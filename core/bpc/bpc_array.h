// An out-of-core array of points over a BPC file: what a vector of points would be if memory were large enough.
//
//   pcm::BpcArray cloud("city.bpc");
//   const auto intensity = cloud.column<std::uint16_t>("intensity");
//   for (auto point : cloud)
//       if (point.position()[2] > 100) point.set(intensity, 0);
//   cloud.flush();
//
// Cost. A point of a chunk in memory: some nanoseconds. A point of another chunk: reading and decoding the columns that
// are used of that chunk (100,000 points: about a millisecond a column); reading on in order, the next chunk is decoded
// on another thread meanwhile. So go through the points in order where there is a choice, or chunk by chunk. Only
// columns that are touched are read. Changed columns that memory has no room for go to a scratch file, uncompressed.
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
    // All that the array may allocate: decoded chunks, coding buffers, what it knows about chunks (some 200 bytes
    // each).
    std::size_t memory_bytes = std::size_t{256} << 20;
    // Of chunks that push_back() begins; 0: default_chunk_points().
    std::size_t chunk_points = 0;
    // Where changed points wait; empty: beside the file. The scratch file has no name while it is used: nothing of it
    // stays behind, however the process ends.
    std::filesystem::path scratch_folder;
    bool read_ahead = true;  // on a thread of its own, where the memory allows it
};

// An attribute of an array's points whose scalars are of type T: made by BpcArray::column, for that array only.
template <class T>
struct BpcColumnOf {
    std::size_t attribute = 0;
    std::uint32_t components = 1;
};

template <class T>
constexpr ScalarType scalar_type_of();

// One thread at a time, reading too, for reading loads. Nothing on disk changes before flush(); the destructor drops
// what was not flushed. Not to be moved: points and iterators refer to it.
class BpcArray {
    struct Resident;

public:
    class Point;
    class Iterator;

    // The cloud in a file: with a cloud block, or bare chunks (at most ChunkIndex::most_places of them). Throws what
    // BpcFile throws, and Error(invalid_argument) when the memory is not enough for two of its chunks and the coding of
    // one.
    explicit BpcArray(const std::filesystem::path& path, const BpcArrayOptions& options = {});
    // No points yet, to be a file of that name; of `cloud` position type, grid, schema and metadata are taken.
    BpcArray(const std::filesystem::path& path, const BpcCloud& cloud, const BpcArrayOptions& options = {});
    ~BpcArray();
    BpcArray(const BpcArray&) = delete;
    BpcArray& operator=(const BpcArray&) = delete;

    std::uint64_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    const Schema& schema() const { return cloud_.schema; }
    // Present when positions are integers on it; else they are doubles.
    const std::optional<Grid>& grid() const { return cloud_.grid; }
    const std::vector<Metadata>& metadata() const { return cloud_.metadata; }

    // Indices must be less than size(). Throws Error(truncated | corrupt | io) when a chunk cannot be read,
    // Error(no_space | io) when one cannot be spilled; the array is as it was then, and the call may be repeated.
    Point operator[](std::uint64_t index);
    Iterator begin();
    Iterator end();

    // Exact, in source units.
    Vec3d position(std::uint64_t index);
    // On a grid: the nearest position of it. Throws Error(invalid_argument) for one that is not finite or beyond 32
    // bits of steps. Doubles keep every bit.
    void set_position(std::uint64_t index, const Vec3d& position);
    // Only on a grid; else Error(invalid_argument).
    std::array<std::int32_t, 3> grid_position(std::uint64_t index);
    void set_grid_position(std::uint64_t index, const std::array<std::int32_t, 3>& position);

    // Throws Error(invalid_argument), naming what there is, when no attribute has the name or its scalars are of
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
    // All points of a batch, behind the last. Throws Error(invalid_argument) for a batch of another shape.
    void append(const PointBatch& batch);

    // Makes the file what the array is: writes the whole of it beside, syncs and renames, so that at any instant,
    // whatever happens to the process or the machine, the name stands for the old cloud or for the new one. Chunks
    // without changes are copied as they are. After an error the array and the old file are as they were.
    void flush();
    // The same under another name; the array stays with its own.
    void save_as(const std::filesystem::path& path);

    struct Statistics {
        std::uint64_t chunks_decoded = 0;     // with or without reading ahead
        std::uint64_t chunks_read_ahead = 0;  // of them, those that were wanted afterwards
        std::uint64_t chunks_evicted = 0;
        std::uint64_t columns_spilled = 0;
        std::size_t most_resident_bytes = 0;  // of decoded columns
    };
    const Statistics& statistics() const { return statistics_; }

private:
    static constexpr std::size_t positions_ = 3;  // columns x, y, z come before the attributes

    struct State;

    // The bytes of a column of the chunk that holds the point; the chunk becomes the window first_, count_.
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
    // The chunk that was used last.
    std::uint64_t first_ = 0;
    std::uint64_t count_ = 0;
    std::byte** window_data_ =
        nullptr;  // null for columns that nobody has touched since the chunk was loaded; x, y, z as one
    std::uint8_t* window_changed_ = nullptr;  // by column
    Statistics statistics_;
    std::unique_ptr<State> state_;
};

// A point of an array: an index that knows its array. Cheap to copy, valid while the array lives.
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
    // The three axes are touched together.
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
