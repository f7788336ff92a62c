// The grid for writing doubles as 32-bit integers, as LAS does: the coarsest that keeps every digit, if one exists.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/io/reader.h"
#include "pcm/system/progress.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pcm {

struct GridProposal {
    Grid grid;
    bool exact = false;  // every watched coordinate v has a q of 32 bits with q * scale + offset == v, bit for bit
    bool decimal_or_exact = true;  // each axis was found by 1, 2 or 3 below: no digit of the coordinates is lost
    double largest_error = 0;      // source units: 0 when exact, else an upper bound of the rounding of any coordinate
    std::uint64_t not_finite = 0;  // points with a NaN or infinite coordinate; they are ignored
};

// Watches all coordinates of a cloud, then proposes. Axes are chosen one by one, in this order:
// 1. a step 10^-k, k = -3..12, on which all coordinates are exact, with offset 0 or the first coordinate rounded to a
//    multiple of 1000: the coarsest, but where finer ones serve as well, one step for all axes and 0.01 at most;
// 2. the coarsest power of two on which they are exact: it exists for coordinates that were integers times such a step;
// 3. a step 10^-k, chosen as in 1, on which all coordinates are exact up to rounding in double precision: decimal
//    numbers from a text (3 * 0.1 != 0.3);
// 4. the finest step 1, 2 or 5 times 10^-k whose 32-bit integers span the coordinates.
//
// One thread.
class GridChoice {
public:
    GridChoice();

    // A batch of doubles.
    void watch(const PointBatch& batch);
    GridProposal propose() const;

private:
    struct Candidate {
        double scale = 1, offset = 0;
        bool from_first = false;
        double error = 0;  // the largest so far; not more than rounding in double precision explains
    };
    struct Axis {
        bool any = false;
        double min = 0, max = 0;
        std::vector<Candidate> decimal;  // steps on which all coordinates so far are right, coarsest first
        int lowest_bit = 0;              // all coordinates are multiples of 2^lowest_bit
        bool all_zero = true;
    };
    void watch(Axis& axis, double v);
    static const Candidate* coarsest(const Axis& axis);
    static const Candidate* coarsest_but_for_rounding(const Axis& axis);
    // A candidate that is as good as `found`, whose step is nearer to `step` and not below it.
    static const Candidate& finer(const Axis& axis, const Candidate& found, double step);
    static bool take_binary(const Axis& axis, double& scale, double& offset);

    std::array<Axis, 3> axes_;
    std::uint64_t not_finite_ = 0;
};

// Reads all points of a cloud of doubles. Throws what read() throws, Error(cancelled), and Error(invalid_argument) for
// a cloud that already has a grid.
GridProposal choose_grid(PointReader& reader, const ProgressFunction& progress = {});

// The integer whose position on the grid is nearest to v, which is finite. It may need more than 32 bits, and saturates
// at +-2^62.
inline std::int64_t nearest_on_grid(const Grid& grid, std::size_t axis, double v)
{
    constexpr double most = 4611686018427387904.0;
    const double steps = std::nearbyint((v - grid.offset[axis]) / grid.scale[axis]);
    if (!(steps > -most)) return -(std::int64_t{1} << 62);
    if (!(steps < most)) return std::int64_t{1} << 62;
    const auto q = static_cast<std::int64_t>(steps);
    const double error = std::abs(grid.to_source(q, axis) - v);
    if (error == 0) return q;
    // The quotient is rounded as well: a neighbour may be nearer.
    if (std::abs(grid.to_source(q + 1, axis) - v) < error) return q + 1;
    if (std::abs(grid.to_source(q - 1, axis) - v) < error) return q - 1;
    return q;
}

}  // namespace pcm
