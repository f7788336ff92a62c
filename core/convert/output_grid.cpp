#include "pcm/convert/output_grid.h"

#include "pcm/cloud/vector.h"
#include "pcm/io/pipe/far_points.h"
#include "pcm/io/pipe/grid_choice.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

namespace pcm {
namespace {

// The cloud's own grid, the one its doubles are near, or the one that PLY and PCD carry as metadata.
std::optional<Grid> source_grid(const FileInfo& info)
{
    if (info.grid) return info.grid;
    if (info.near_grid) return info.near_grid;
    for (const Metadata& block : info.metadata) {
        if (block.key != "pcm.grid") continue;
        const char* at = reinterpret_cast<const char*>(block.value.data());
        const char* const end = at + block.value.size();
        std::array<double, 6> numbers{};
        bool whole = true;
        for (double& number : numbers) {
            while (at < end && *at == ' ') ++at;
            const auto result = std::from_chars(at, end, number);
            whole = whole && result.ec == std::errc() && std::isfinite(number);
            at = result.ptr;
        }
        const Grid grid{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
        if (whole && grid.scale[0] > 0 && grid.scale[1] > 0 && grid.scale[2] > 0) return grid;
    }
    return std::nullopt;
}

// Whether all coordinates fit 32 bits on a grid, and the largest rounding error there.
class OnGrid {
public:
    explicit OnGrid(const Grid& grid) : grid_(grid) {}
    void watch(std::size_t axis, double v)
    {
        const std::int64_t q = nearest_on_grid(grid_, axis, v);
        fits_ = fits_ && q >= std::numeric_limits<std::int32_t>::min() && q <= std::numeric_limits<std::int32_t>::max();
        error_ = std::max(error_, std::fabs(grid_.to_source(q, axis) - v));
    }
    bool fits() const { return fits_; }
    double error() const { return error_; }
    const Grid& grid() const { return grid_; }

private:
    Grid grid_;
    bool fits_ = true;
    double error_ = 0;
};

// A grid whose offset is a round number of steps near the middle of the coordinates.
Grid around(const Box3d& box, const Vec3d& scale)
{
    Grid grid;
    grid.scale = scale;
    for (std::size_t a = 0; a < 3; ++a) {
        const double middle = box.empty() ? 0 : box.min[a] + (box.max[a] - box.min[a]) / 2;
        const double round = std::pow(10.0, std::ceil(std::log10(scale[a]) + 6));  // a million steps or more
        grid.offset[a] = std::isfinite(round) && round > 0 ? std::round(middle / round) * round : middle;
    }
    return grid;
}

// How much the numbers of the source are rounded themselves, most of them: half the last bit of a float or double.
double own_rounding(const FileInfo& info, const FarPoints& positions)
{
    return std::ldexp(positions.usual_magnitude(), info.position_type == ScalarType::f32 ? -25 : -54);
}

// Throws when positions are rounded by up to `error` because some are too far from the others.
void refuse_far_points(const FarPoints& points, double error)
{
    const auto steps = [&](const Box3d& box) {
        if (box == points.box()) return Vec3d{2 * error, 2 * error, 2 * error};
        Vec3d step;
        for (std::size_t a = 0; a < 3; ++a) step[a] = std::ldexp(box.max[a] / 2 - box.min[a] / 2, -31);
        return step;
    };
    points.refuse(steps, "a grid of 32-bit integers");
}

}  // namespace

OutputGrid choose_output_grid(PointReader& cloud, const std::optional<Vec3d>& scale,
                              const std::function<void(double)>& progress)
{
    OutputGrid result;
    std::optional<Grid> candidate = source_grid(cloud.info());
    if (scale) {
        Grid grid;
        if (candidate) grid = *candidate;
        grid.scale = *scale;
        candidate = grid;
    }
    std::optional<OnGrid> on_candidate;
    if (candidate) on_candidate.emplace(*candidate);
    GridChoice choice;
    FarPoints positions;
    Box3d box;
    PointBatch batch;
    while (cloud.read(batch, default_batch_points)) {
        result.points_read += batch.size;
        if (!scale) choice.watch(batch);
        const Grid* grid = cloud.info().grid ? &*cloud.info().grid : nullptr;
        for (std::size_t i = 0; i < batch.size; ++i) {
            Vec3d p;
            for (std::size_t a = 0; a < 3; ++a)
                p[a] = grid ? grid->to_source(batch.grid_xyz[a][i], a) : batch.xyz[a][i];
            if (!is_finite(p)) continue;
            box.extend(p);
            positions.watch(p);
            if (on_candidate)
                for (std::size_t a = 0; a < 3; ++a) on_candidate->watch(a, p[a]);
        }
        progress(cloud.fraction_read());
    }
    if (scale) {
        result.grid = on_candidate->fits() ? *candidate : around(box, *scale);
        return result;
    }
    if (on_candidate && on_candidate->fits() && on_candidate->error() == 0) {
        result.grid = *candidate;
        return result;
    }
    const GridProposal proposal = choice.propose();
    double error = proposal.exact ? 0 : proposal.largest_error;
    result.grid = proposal.grid;
    if (on_candidate && on_candidate->fits() && on_candidate->error() <= error) {
        result.grid = *candidate;
        error = on_candidate->error();
    }
    if (proposal.decimal_or_exact || error == 0) return result;
    refuse_far_points(positions, error);
    if (error <= own_rounding(cloud.info(), positions)) return result;
    result.notes.push_back("positions are rounded to steps of " + brief(result.grid.scale[0]) + ", " +
                           brief(result.grid.scale[1]) + ", " + brief(result.grid.scale[2]) + ", by up to " +
                           brief(error) + ": their digits are more than the output's 32-bit integers hold");
    return result;
}

}  // namespace pcm
