#include "pcm/fit/noise_mixture.h"

#include "pcm/cloud/vector.h"
#include "pcm/fit/tuning.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr double most_reach = 300;

double gauss(double c) { return std::exp(-c * c / 2) / std::sqrt(2 * pi); }
double within(double c) { return std::erf(c / std::sqrt(2.0)); }

// Mean square of a Gaussian cut at c deviations, in units of the cut.
double cut_square(double c) { return (1 - 2 * c * gauss(c) / within(c)) / (c * c); }

// The c of such a mean square: it falls from 1 / 3.
double reach_of(double square)
{
    double low = 0.3, high = most_reach;
    if (!(square < cut_square(low))) return low;
    if (!(square > cut_square(high))) return high;
    for (int k = 0; k < 50 && high - low > 1e-4 * high; ++k) {
        const double middle = std::sqrt(low * high);
        (cut_square(middle) > square ? low : high) = middle;
    }
    return std::sqrt(low * high);
}

// Equivalent sharp cut for weights that fall towards the threshold, relative to it.
constexpr double tapered_cut = 0.95;

double taper(double part)
{
    constexpr double from = NoiseMixture::taper_from;
    if (part <= from) return 1;
    const double x = std::min(1.0, (part - from) / (1 - from));
    return (1 - x * x) * (1 - x * x);
}

}  // namespace

double deviation_of_cut(double rms, double threshold)
{
    const double square = rms / threshold * (rms / threshold);
    return std::isfinite(threshold) && square > 0.04 ? threshold / reach_of(square) : rms;
}

double density_at_cut(double deviation, double threshold, double points)
{
    if (!std::isfinite(threshold) || !(deviation > 0)) return 0;
    const double reach = threshold / deviation;
    return points * 2 * reach * gauss(reach) / within(reach);
}

NoiseMixture::NoiseMixture(double threshold, double share, double deviation)
    : threshold_(threshold), share_(std::clamp(share, 0.05, 1.0)), deviation_(deviation)
{
    const MixtureTuning& tuned = fit_tuning().mixture;
    all_ = !(deviation > 0 && share_ <= tuned.max_share && threshold / deviation >= tuned.min_reach);
    if (!all_) make_table();
}

bool NoiseMixture::needs_bins() const { return std::isfinite(threshold_) && share_ <= fit_tuning().mixture.max_share; }

bool NoiseMixture::let_all_belong(double rms)
{
    const bool change = !all_;
    all_ = true;
    deviation_ = deviation_of_cut(rms, tapered_cut * threshold_);
    return change;
}

bool NoiseMixture::learn(const DistanceBins& bins, double rms)
{
    double points = 0;
    for (const double count : bins.counts) points += count;
    const double min_reach = fit_tuning().mixture.min_reach;
    if (!needs_bins() || points < static_cast<double>(fit_tuning().mixture.min_points)) return let_all_belong(rms);
    double reach = std::clamp(deviation_ > 0 ? threshold_ / deviation_ : 3, min_reach, most_reach);
    constexpr double width = 1.0 / static_cast<double>(DistanceBins::size);
    for (int round = 0; round < 20; ++round) {
        double belong = 0, square = 0;
        const double top = share_ * 2 * reach * gauss(0) / within(reach);
        for (std::size_t i = 0; i < DistanceBins::size; ++i) {
            const double at = (static_cast<double>(i) + 0.5) * width, c = at * reach;
            const double noise = top * std::exp(-c * c / 2);
            const double part = bins.counts[i] * noise / (noise + 1 - share_);
            belong += part;
            square += part * (at * at + width * width / 12);
        }
        if (!(belong > 0)) return let_all_belong(rms);
        const double next = reach_of(square / belong);
        const bool done = std::fabs(next - reach) < 1e-3 * reach;
        reach = next;
        if (done || reach < min_reach) break;
    }
    if (reach < min_reach) return let_all_belong(rms);
    if (!all_ && std::fabs(threshold_ / reach - deviation_) < 0.02 * deviation_) return false;
    all_ = false;
    deviation_ = threshold_ / reach;
    make_table();
    return true;
}

void NoiseMixture::make_table()
{
    table_step_ = threshold_ / static_cast<double>(table_size);
    const double reach = threshold_ / deviation_, top = share_ * 2 * reach * gauss(0) / within(reach);
    for (std::size_t i = 0; i < table_.size(); ++i) {
        const double part = static_cast<double>(i) / static_cast<double>(table_size), c = part * reach;
        const double noise = top * std::exp(-c * c / 2);
        table_[i].weight = taper(part) * noise / (noise + 1 - share_);
    }
    for (std::size_t i = 0; i < table_size; ++i) {
        Row &row = table_[i], &next = table_[i + 1];
        const double from = static_cast<double>(i) * table_step_, grows = next.weight - row.weight;
        row.grows = grows / table_step_;
        next.cost = row.cost + table_step_ * (2 * from * row.weight + from * grows +
                                              table_step_ * (row.weight + grows * (2.0 / 3)));
    }
}

}  // namespace pcm
