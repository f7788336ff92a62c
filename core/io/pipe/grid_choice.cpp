#include "pcm/io/pipe/grid_choice.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

namespace pcm {
namespace {

constexpr int coarsest_decimal = -3, finest_decimal = 12;
// Decimal steps are not written any coarser, where a finer one serves as well: programs show as many decimals as the
// step has.
constexpr double coarsest_written = 0.01;
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

// The double nearest to digits * 10^exponent: computed powers would be rounded.
double decimal(long long digits, int exponent)
{
    return std::strtod((std::to_string(digits) + "e" + std::to_string(exponent)).c_str(), nullptr);
}

// 1, 2 or 5 times 10^exponent.
struct RoundStep {
    long long digits = 1;
    int exponent = 0;
    double value() const { return decimal(digits, exponent); }
};

// The smallest that is not below `least_step`.
RoundStep round_step(double least_step)
{
    const auto exponent =
        static_cast<int>(std::floor(std::log10(std::max(least_step, std::numeric_limits<double>::min()))));
    for (const long long digits : {1, 2, 5})
        if (decimal(digits, exponent) >= least_step) return {digits, exponent};
    return {1, exponent + 1};
}

// The multiple of the step that is nearest to v, as a decimal.
double nearest_multiple(const RoundStep& step, double v)
{
    const double steps = std::nearbyint(v / step.value());
    if (!(std::fabs(steps) < 1e17)) return steps * step.value();
    return decimal(static_cast<long long>(steps) * step.digits, step.exponent);
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

const GridChoice::Candidate* GridChoice::coarsest(const Axis& axis)
{
    const auto exact = std::find_if(axis.decimal.begin(), axis.decimal.end(),
                                    [](const Candidate& candidate) { return candidate.error == 0; });
    return exact != axis.decimal.end() ? &*exact : nullptr;
}

const GridChoice::Candidate* GridChoice::coarsest_but_for_rounding(const Axis& axis)
{
    if (axis.decimal.empty()) return nullptr;
    return &*std::min_element(axis.decimal.begin(), axis.decimal.end(), [](const Candidate& x, const Candidate& y) {
        return x.scale != y.scale ? x.scale > y.scale : x.error < y.error;
    });
}

const GridChoice::Candidate& GridChoice::finer(const Axis& axis, const Candidate& found, double step)
{
    const Candidate* best = &found;
    for (const Candidate& candidate : axis.decimal)
        if (candidate.scale >= step && candidate.scale < best->scale && candidate.from_first == found.from_first &&
            (candidate.error == 0 || found.error != 0))
            best = &candidate;
    return *best;
}

// The coarsest power of two on which all coordinates are exact, if its integers have 32 bits.
bool GridChoice::take_binary(const Axis& axis, double& scale, double& offset)
{
    // Halves, because the difference of two finite numbers may be infinite.
    const double half_span = axis.max / 2 - axis.min / 2;
    const double binary = std::ldexp(1.0, axis.lowest_bit);
    if (!(binary > 0) || !(half_span / binary <= most - 1)) return false;
    // The middle, as a multiple of the step: every q * scale + offset is then exact.
    const double middle = std::nearbyint((axis.min / 2 + axis.max / 2) / binary) * binary;
    const auto fits = [&](double v) {
        const double q = std::nearbyint((v - middle) / binary);
        return q >= least && q <= most && q * binary + middle == v;
    };
    if (!fits(axis.min) || !fits(axis.max)) return false;
    scale = binary;
    offset = middle;
    return true;
}

GridProposal GridChoice::propose() const
{
    GridProposal proposal;
    proposal.exact = true;
    proposal.not_finite = not_finite_;
    std::array<const Candidate*, 3> found{};
    double finest = coarsest_written;
    for (std::size_t a = 0; a < 3; ++a) {
        const Axis& axis = axes_[a];
        double& scale = proposal.grid.scale[a];
        double& offset = proposal.grid.offset[a];
        scale = 0.001;
        if (!axis.any) continue;
        if (!(found[a] = coarsest(axis))) {
            if (take_binary(axis, scale, offset)) continue;
            found[a] = coarsest_but_for_rounding(axis);
        }
        if (found[a]) {
            finest = std::min(finest, found[a]->scale);
            continue;
        }
        const RoundStep step = round_step((axis.max / 2 - axis.min / 2) / (most - 2));
        scale = step.value();
        offset = nearest_multiple(step, axis.min / 2 + axis.max / 2);
        const double farthest = std::max(std::abs(axis.min), std::abs(axis.max));
        const double last_place = std::nextafter(farthest, std::numeric_limits<double>::infinity()) - farthest;
        proposal.exact = proposal.decimal_or_exact = false;
        proposal.largest_error = std::max(proposal.largest_error, scale / 2 + 2 * last_place);
    }
    // A step reads like a precision: the same for all decimal axes.
    for (std::size_t a = 0; a < 3; ++a) {
        if (!found[a]) continue;
        const Candidate& candidate = finer(axes_[a], *found[a], finest);
        proposal.grid.scale[a] = candidate.scale;
        proposal.grid.offset[a] = candidate.offset;
        proposal.exact = proposal.exact && candidate.error == 0;
        proposal.largest_error = std::max(proposal.largest_error, candidate.error);
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
