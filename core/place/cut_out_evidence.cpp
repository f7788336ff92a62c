#include "pcm/place/cut_out_evidence.h"

#include "pcm/fit/near_tree.h"
#include "pcm/fit/tuning.h"
#include "pcm/place/grow_shape.h"
#include "pcm/place/tuning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pcm {
namespace {

// Points by chance are in all of these bands, on both sides; another face of a plate is in some.
constexpr std::size_t bands_per_threshold = 2, bands = bands_per_threshold * std::size_t(around_thresholds - 1);

// The points within the threshold, relative to the first of all.
struct Inside {
    Inside(const Shape& shape, double threshold, const std::vector<Vec3d>& points)
    {
        for (const Vec3d& p : points) {
            const double d = signed_distance(shape, p);
            if (!(std::fabs(d) <= threshold)) continue;
            for (std::size_t a = 0; a < 3; ++a) at[a].push_back(p[a] - points.front()[a]);
            distance.push_back(d);
        }
    }
    std::array<std::vector<double>, 3> at;
    std::vector<double> distance;
};

}  // namespace

bool CutOutEvidence::is_cut_out(double noise) const
{
    const CutOutTuning& tuned = place_tuning().cut_outs;
    return overshoot > tuned.max_overshoot && (bend > tuned.max_bend || noise > tuned.max_noise);
}

bool CutOutEvidence::is_by_chance() const { return chance > fit_tuning().consensus.max_chance; }

bool CutOutEvidence::is_crossed() const { return crossing > place_tuning().cut_outs.min_crossing; }

CutOutEvidence cut_out_evidence(const Shape& shape, double threshold, const std::vector<Vec3d>& points)
{
    CutOutEvidence result;
    const std::size_t neighbours = place_tuning().evidence.neighbours;
    const Inside inside(shape, threshold, points);
    const std::size_t count = inside.distance.size();
    if (count < neighbours) return result;
    const NearTree tree(inside.at[0], inside.at[1], inside.at[2]);
    std::vector<NearTree::Near> near;
    std::vector<double> spacings;
    double squares = 0, smooth = 0;
    for (std::size_t i = 0; i < count; ++i) {
        tree.nearest({inside.at[0][i], inside.at[1][i], inside.at[2][i]}, neighbours, near);
        double sum = 0;
        for (const NearTree::Near& n : near) sum += inside.distance[n.index];
        const double mean = sum / static_cast<double>(near.size());
        squares += inside.distance[i] * inside.distance[i];
        smooth += mean * mean;
        spacings.push_back(near[4].square);
    }
    std::nth_element(spacings.begin(), spacings.begin() + static_cast<std::ptrdiff_t>(count / 2), spacings.end());
    const double spacing = std::sqrt(spacings[count / 2]);
    const double slant = place_tuning().cut_outs.min_slant, gap = place_tuning().cut_outs.gap * spacing;
    std::size_t overshoot = 0;
    std::array<double, 2 * bands> beside{};  // points next to the shape, by their distance
    for (const Vec3d& p : points) {
        const double distance = signed_distance(shape, p), outside = std::fabs(distance) - threshold;
        if (!(outside > 0 && outside <= (around_thresholds - 1) * threshold)) continue;
        const auto band = static_cast<std::size_t>(outside / threshold * bands_per_threshold);
        beside[std::min(band, bands - 1) + (distance > 0 ? bands : 0)] += 1;
        tree.nearest(p - points.front(), 1, near);
        overshoot += std::sqrt(near[0].square) > slant * outside + gap;
    }
    result.overshoot = static_cast<double>(overshoot) / static_cast<double>(count);
    const double fullest = *std::max_element(beside.begin(), beside.end());
    if (fullest > 0) result.crossing = std::max(beside[0], beside[bands]) / fullest;
    std::nth_element(beside.begin(), beside.begin() + bands, beside.end());
    result.chance = 2 * bands_per_threshold * beside[bands] / static_cast<double>(count);
    result.bend = squares > 0 ? smooth / squares : 0;
    return result;
}

}  // namespace pcm
