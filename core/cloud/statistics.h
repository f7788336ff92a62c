// What the values of a cloud are, collected in one pass over its points in bounded memory.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/point_batch.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// Statistics of one component: values raw * scale + offset. Without any finite value least, most and mean are 0.
struct ValueStatistics {
    std::uint64_t values = 0;      // finite ones
    std::uint64_t not_finite = 0;  // NaN and infinite ones
    double least = 0, most = 0, mean = 0;
};

// Points at the position of an earlier point, in all three coordinates to the last bit. Exact up to a collision of
// 64-bit hashes while the positions fit the memory; else an estimate from those positions whose hash falls into a share
// of 1/one_in: its standard error is stated.
struct DuplicateStatistics {
    double points = 0;
    bool exact = true;
    std::uint64_t one_in = 1;
    double standard_error = 0;
};

struct CloudStatistics {
    std::uint64_t points = 0;
    std::uint64_t not_finite = 0;  // points with a NaN or infinite coordinate; they have no part in box and duplicates
    Box3d box;
    std::array<ValueStatistics, 3> position;               // x, y, z
    std::vector<std::vector<ValueStatistics>> attributes;  // per attribute and component
    // Number of points by value of "classification", "return_number" and "number_of_returns", where the cloud has them
    // as integers of one component: 256 numbers. `other_*`: values outside 0 to 255.
    std::vector<std::uint64_t> classes, return_numbers, numbers_of_returns;
    std::uint64_t other_classes = 0;
    DuplicateStatistics duplicates;
};

// One thread. Memory: at most 64 bytes for each of `most_positions`.
class StatisticsCollector {
public:
    StatisticsCollector(const Schema& schema, const std::optional<Grid>& grid,
                        std::size_t most_positions = std::size_t{1} << 22);

    // A batch of the cloud, gridded exactly when there is a grid.
    void add(const PointBatch& batch);
    CloudStatistics result() const;

private:
    struct Entry {
        std::uint64_t hash = 0;
        std::uint64_t points = 0;  // 0: a free place
    };
    void add_positions(const PointBatch& batch);
    void add_attribute(const Column& column, std::size_t attribute);
    void count_position(std::uint64_t hash);
    void insert(std::uint64_t hash, std::uint64_t points);
    void rebuild(std::size_t places);

    const Schema schema_;
    const std::optional<Grid> grid_;
    const std::size_t most_positions_;
    CloudStatistics found_;
    std::array<long double, 3> position_sums_{};
    std::vector<std::vector<long double>> sums_;
    std::vector<Entry> table_;  // open addressing
    std::size_t entries_ = 0;
    unsigned level_ = 0;  // only hashes with this many zeros at their end are counted
};

}  // namespace pcm
