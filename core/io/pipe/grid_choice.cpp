#include "pcm/io/pipe/grid_choice.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace pcm {
namespace {

constexpr int coarsest_decimal = -3, finest_decimal = 12;
constexpr double least = std::numeric_limits<std::int32_t>::min(), most = std::numeric_limits<std::int32_t>::max();

// The double nearest to 10^-k: literals, because computed powers would be rounded.
double decimal_step(int k)
{
    static constexpr double steps[] = {1e3,  1e2,  1e1,  1e0,  1e-1, 1e-2,  1e-3,  1e-4,
                                       1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};
    return steps[k - coarsest_decimal];
}

// v = odd * 2^result, v not 0 and finite.
int lowest_bit_of(double v)
{
    int exponent;
    const double mantissa = std::frexp(std::abs(v), &exponent);  // 0.5 <= mantissa < 1
    auto bits = static_cast<std::uint64_t>(std::ldexp(mantissa, 53));
    int zeros = 0;
    for (; !(bits & 1); bits >>= 1) ++zeros;
    return exponent - 53 + zeros;
}

// The smallest of 1, 2 and 5 times 10^k that is not below `least_step`.
double round_step(double least_step)
{
    const double power =
        std::pow(10.0, std::floor(std::log10(std::max(least_step, std::numeric_limits<double>::min()))));
    for (const double times : {1.0, 2.0, 5.0, 10.0})
        if (power * times >= least_step) return power * times;
    return power;
}

}  // namespace

GridChoice::GridChoice()
{
    for (Axis& axis : axes_)
        for (int k = coarsest_decimal; k <= finest_decimal; ++k)
            for (const bool from_first : {false, true}) axis.decimal.push_back({decimal_step(k), 0, from_first});
}

void GridChoice::watch(Axis& axis, double v)
{
    if (!axis.any) {
        axis.any = true;
        axis.min = axis.max = v;
        const double rounded = std::nearbyint(v / 1000) * 1000;
        for (Candidate& candidate : axis.decimal)
            if (candidate.from_first) candidate.offset = rounded;
        // Near the origin both are the same.
        if (rounded == 0)
            axis.decimal.erase(std::remove_if(axis.decimal.begin(), axis.decimal.end(),
                                              [](const Candidate& c) { return c.from_first; }),
                               axis.decimal.end());
    }
    axis.min = std::min(axis.min, v);
    axis.max = std::max(axis.max, v);
    for (std::size_t i = 0; i < axis.decimal.size();) {
        Candidate& candidate = axis.decimal[i];
        const double q = std::nearbyint((v - candidate.offset) / candidate.scale);
        const double error = std::abs(q * candidate.scale + candidate.offset - v);
        // The step itself, the product and the sum are rounded, each by half a unit in the last place at most.
        constexpr double unit = std::numeric_limits<double>::epsilon();
        if (q >= least && q <= most && error <= unit * (std::abs(q * candidate.scale) + std::abs(v))) {
            candidate.error = std::max(candidate.error, error);
            ++i;
        } else {
            axis.decimal.erase(axis.decimal.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }
    if (v != 0) {
        const int bit = lowest_bit_of(v);
        axis.lowest_bit = axis.all_zero ? bit : std::min(axis.lowest_bit, bit);
        axis.all_zero = false;
    }
}

void GridChoice::watch(const PointBatch& batch)
{
    if (batch.gridded)
        throw Error(ErrorCode::invalid_argument, {}, "the positions already have a grid; doubles were expected");
    for (std::size_t i = 0; i < batch.size; ++i) {
        if (!std::isfinite(batch.xyz[0][i]) || !std::isfinite(batch.xyz[1][i]) || !std::isfinite(batch.xyz[2][i])) {
            ++not_finite_;
            continue;
        }
        for (std::size_t a = 0; a < 3; ++a) watch(axes_[a], batch.xyz[a][i]);
    }
}

GridProposal GridChoice::propose() const
{
    GridProposal proposal;
    proposal.exact = true;
    proposal.not_finite = not_finite_;
    for (std::size_t a = 0; a < 3; ++a) {
        const Axis& axis = axes_[a];
        double& scale = proposal.grid.scale[a];
        double& offset = proposal.grid.offset[a];
        if (!axis.any) {
            scale = 0.001;
            continue;
        }
        const auto take = [&](const Candidate& candidate) {
            scale = candidate.scale;
            offset = candidate.offset;
            proposal.exact = proposal.exact && candidate.error == 0;
            proposal.largest_error = std::max(proposal.largest_error, candidate.error);
        };
        const auto exact = std::find_if(axis.decimal.begin(), axis.decimal.end(),
                                        [](const Candidate& candidate) { return candidate.error == 0; });
        if (exact != axis.decimal.end()) {
            take(*exact);
            continue;
        }
        // Halves, because the difference of two finite numbers may be infinite.
        const double half_span = axis.max / 2 - axis.min / 2;
        const double binary = std::ldexp(1.0, axis.lowest_bit);
        if (binary > 0 && half_span / binary <= most - 1) {
            scale = binary;
            // The middle, as a multiple of the step: every q * scale + offset is then exact.
            offset = std::nearbyint((axis.min / 2 + axis.max / 2) / binary) * binary;
            const auto fits = [&](double v) {
                const double q = std::nearbyint((v - offset) / scale);
                return q >= least && q <= most && q * scale + offset == v;
            };
            if (fits(axis.min) && fits(axis.max)) continue;
        }
        if (!axis.decimal.empty()) {
            take(
                *std::min_element(axis.decimal.begin(), axis.decimal.end(), [](const Candidate& x, const Candidate& y) {
                    return x.scale != y.scale ? x.scale > y.scale : x.error < y.error;
                }));
            continue;
        }
        const double step = round_step(half_span / (most - 2));
        scale = step;
        offset = std::nearbyint((axis.min / 2 + axis.max / 2) / step) * step;
        const double farthest = std::max(std::abs(axis.min), std::abs(axis.max));
        const double last_place = std::nextafter(farthest, std::numeric_limits<double>::infinity()) - farthest;
        proposal.exact = false;
        proposal.largest_error = std::max(proposal.largest_error, step / 2 + 2 * last_place);
    }
    return proposal;
}

GridProposal choose_grid(PointReader& reader, const ProgressFunction& progress)
{
    if (reader.info().grid)
        throw Error(ErrorCode::invalid_argument, {}, "the positions already have a grid; doubles were expected");
    GridChoice choice;
    PointBatch batch;
    while (reader.read(batch, default_batch_points)) {
        choice.watch(batch);
        ProgressUpdate update;
        update.stage = "Examining the coordinates";
        update.fraction = reader.fraction_read();
        if (progress && !progress(update)) throw Error(ErrorCode::cancelled, {}, "cancelled");
    }
    return choice.propose();
}

}  // namespace pcm
