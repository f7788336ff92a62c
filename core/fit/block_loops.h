// The innermost loops of fits, over blocks of points: distances, derivatives, weights and sums. Compiled once per level
// of system/cpu.h, out of block_loops_source.h; all levels give the same bits. Plain arrays throughout: see there.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcm {

inline constexpr std::size_t most_parameters = 7;
inline constexpr std::size_t patch_block = 256;  // points that are differentiated at once

// Distances of a block of points and their derivatives by the parameters.
struct PatchBlock {
    alignas(64) double distance[patch_block];
    alignas(64) double by[most_parameters][patch_block];
};

// How its points count.
struct BlockWeights {
    alignas(64) double within[patch_block];  // 1 for points that count, else 0
    alignas(64) double weight[patch_block];
    alignas(64) double slope[patch_block];  // growth of weight times distance, per distance
    alignas(64) double cost[patch_block];
};

// Their sums: see PatchSums.
struct BlockSums {
    double used, slope, squares, pull, cost;
    double gradient[most_parameters], products[most_parameters * most_parameters];
};

// Weights by distance: `rows` of three numbers, weight, its growth per distance, and cost, one per `step` of the
// distance, and a last one for all beyond.
struct WeightTable {
    const double* rows;
    std::int32_t size;  // without the last
    double step, per_length;
};

// Point, axis, radius and second number of a shape.
struct ShapeNumbers {
    double point[3], axis[3], radius, second;
};
// Place, directions and curvature of a patch.
struct PatchNumbers {
    double place[3], a[3], n[3], b[3], curvature;
};

// Loops over up to patch_block points; distances of any number.
struct ShapeLoops {
    void (*distances)(const ShapeNumbers& shape, const double* x, const double* y, const double* z, std::size_t count,
                      double* out);
    void (*differentiate)(const PatchNumbers& patch, const double* x, const double* y, const double* z,
                          std::size_t count, PatchBlock& out);
};

// What the points around a surface show: see BandFacts.
struct BlockFacts {
    double within, around, sum, largest;
};

struct BlockLoops {
    ShapeLoops plane, cylinder, sphere;

    // For columns of any length: the largest |value - shift|; sums of values times a factor, and of products of two
    // columns, each shifted and times the factor. Not finite where a value is not.
    double (*largest)(const double* values, std::size_t count, double shift);
    double (*sum_scaled)(const double* values, std::size_t count, double factor);
    double (*sum_products)(const double* a, const double* b, std::size_t count, double shift_a, double shift_b,
                           double factor);

    // Squares of distances, at most `limit` each, and how many are not above it.
    void (*score)(const double* distances, std::size_t count, double limit, double* squares, double* near);
    // Sets `within`; returns how many.
    double (*within)(const PatchBlock& block, std::size_t count, double threshold, BlockWeights& weights);
    // Sets weight, slope and cost: 1, and the square of the distance, or `beyond`.
    void (*weigh_alike)(const PatchBlock& block, std::size_t count, double beyond, BlockWeights& weights);
    // The same, with weights (1 - u^2)^2 where u grows from 0 at `from`, below the threshold, to 1 there. `support`: a
    // factor of each point's part; null: 1.
    void (*weigh_tapered)(const PatchBlock& block, std::size_t count, double from, double threshold,
                          const double* support, BlockWeights& weights);
    // By a table.
    void (*weigh)(const PatchBlock& block, std::size_t count, const WeightTable& table, const double* support,
                  BlockWeights& weights);
    // Which of `bins` bins up to the threshold each distance is in; `bins` for those beyond.
    void (*find_bins)(const PatchBlock& block, std::size_t count, double threshold, std::int32_t bins,
                      std::int32_t* to);
    // Sets the sums of a block. Its arrays are filled up to a multiple of eight points.
    void (*sum)(PatchBlock& block, BlockWeights& weights, std::size_t count, std::size_t parameters, BlockSums& sums);
    // Sum of squares of the distances of those that count.
    double (*squares)(const PatchBlock& block, const BlockWeights& weights, std::size_t count);
    // The cost alone.
    double (*cost)(const BlockWeights& weights, std::size_t count);
    // Adds to the facts. `inverse`: inverse of the products, row by row.
    void (*facts)(const PatchBlock& block, std::size_t count, std::size_t parameters, const double* inverse,
                  double threshold, BlockFacts& facts);
};

// Those of simd_level() when it was first asked; throws what that throws.
const BlockLoops& block_loops();

const BlockLoops& baseline_block_loops();
const BlockLoops& avx2_block_loops();
const BlockLoops& avx512_block_loops();

}  // namespace pcm
