#include "pcm/primitives/cloud_survey.h"

#include "pcm/primitives/local_surface.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t patches_per_place = 400;
constexpr double noise_share = 0.35;  // of the patches are smoother than what counts as noise: others are no surfaces

std::vector<std::uint32_t> around(const SurfaceSample& sample, std::uint32_t seed, std::size_t most)
{
    std::vector<std::uint32_t> points{seed};
    std::vector<std::uint32_t> seen{seed};
    for (std::size_t next = 0; next < points.size() && points.size() < most; ++next) {
        const std::uint32_t* const near = sample.neighbours(points[next]);
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours && points.size() < most; ++k) {
            const auto at = std::lower_bound(seen.begin(), seen.end(), near[k]);
            if (at != seen.end() && *at == near[k]) continue;
            seen.insert(at, near[k]);
            points.push_back(near[k]);
        }
    }
    return points;
}

// Standard deviation across a paraboloid: of a patch that is wide beside it, so that the noise does not choose the
// patch's points.
double noise_at(const SurfaceSample& sample, std::uint32_t seed)
{
    const std::vector<std::uint32_t> points = around(sample, seed, 384);
    double noise = -1;
    for (const std::size_t size : {24, 96, 384}) {
        if (points.size() < size) break;
        const auto surface = fit_local_surface(sample, points.data(), size, std::numeric_limits<double>::infinity());
        if (!surface) break;
        noise = surface->rms;
        if (surface->extent > 8 * noise) break;
    }
    return noise;
}

double quantile(std::vector<double>& values, double share)
{
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

CloudSurvey survey_cloud(const ChosenPoints& points, const std::vector<Box3i>& places,
                         const std::function<void()>& check)
{
    std::vector<double> spacings, noises;
    SampleSettings settings;
    settings.level = points.tree().info().levels;
    settings.cell = largest_magnitude(points.tree().info().grid.scale);
    for (const Box3i& place : places) {
        check();
        const SurfaceSample sample = sample_surface(points, place, settings);
        const std::size_t step = std::max<std::size_t>(1, sample.size() / patches_per_place);
        for (std::size_t i = 0; i < sample.size(); i += step) {
            if (sample.spacing[i] > 0) spacings.push_back(sample.spacing[i] / 1.2);
            const double noise = noise_at(sample, static_cast<std::uint32_t>(i));
            if (noise >= 0) noises.push_back(noise);
        }
    }
    CloudSurvey survey;
    survey.spacing = quantile(spacings, 0.5);
    survey.noise = quantile(noises, noise_share);
    return survey;
}

}  // namespace pcm
