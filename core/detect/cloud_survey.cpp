#include "pcm/detect/cloud_survey.h"

#include "pcm/cloud/numbers.h"
#include "pcm/detect/local_surface.h"
#include "pcm/detect/tuning.h"
#include "pcm/knn/unit_plan.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t most_patches = 200;  // patches of a place
constexpr std::size_t all_patches = 4800;  // patches of all places
constexpr std::size_t places_per_region = 3;
constexpr double place_points = 2000;

// Patches of a sample.
class Patches {
public:
    explicit Patches(const SurfaceSample& sample) : sample_(sample), seen_(sample.size(), 0) {}

    // Up to `most` points around the seed, in the order of edges.
    std::vector<std::uint32_t> around(std::uint32_t seed, std::size_t most)
    {
        ++stamp_;
        std::vector<std::uint32_t> points{seed};
        seen_[seed] = stamp_;
        for (std::size_t next = 0; next < points.size() && points.size() < most; ++next) {
            const std::uint32_t* const near = sample_.neighbours(points[next]);
            for (std::size_t k = 0; k < SurfaceSample::most_neighbours && points.size() < most; ++k) {
                if (seen_[near[k]] == stamp_) continue;
                seen_[near[k]] = stamp_;
                points.push_back(near[k]);
            }
        }
        return points;
    }

private:
    const SurfaceSample& sample_;
    std::vector<std::uint32_t> seen_;
    std::uint32_t stamp_ = 0;
};

// Standard deviation across a paraboloid of a patch that is wide relative to it, so that the noise does not choose the
// patch's points.
double noise_at(const SurfaceSample& sample, const std::vector<std::uint32_t>& points)
{
    double noise = -1;
    for (const std::size_t size : patch_sizes) {
        if (points.size() < size) break;
        const auto surface = fit_local_surface(sample, points.data(), size, infinity);
        if (!surface) break;
        noise = surface->rms;
        if (surface->extent > detect_tuning().survey.min_patch_width * noise) break;
    }
    return noise;
}

Vec3i middle_of(const Box3i& box)
{
    Vec3i middle;
    for (std::size_t a = 0; a < 3; ++a) middle[a] = box.min[a] + (box.max[a] - box.min[a]) / 2;
    return middle;
}

// All regions of a group are quiet where more than half of them are: few gaps in the middle of a plant.
void fill_groups(const std::vector<Box3i>& regions, const std::vector<Box3i>& groups, std::vector<std::uint8_t>& quiet)
{
    for (const Box3i& group : groups) {
        std::vector<std::size_t> inside;
        std::size_t count = 0;
        for (std::size_t r = 0; r < regions.size(); ++r)
            if (group.contains(middle_of(regions[r]))) {
                inside.push_back(r);
                count += quiet[r];
            }
        if (2 * count <= inside.size()) continue;
        for (const std::size_t r : inside) quiet[r] = 1;
    }
}

// About place_points in a box: half by half the one with more points, but for half number `i` from the first on, which
// is the other; 0: none is.
Box3i dense_place(const Tree& tree, Box3i box, std::size_t i)
{
    for (std::size_t step = 1;; ++step) {
        const std::vector<Box3i> halves = halves_of(box, tree.info().grid.scale);
        if (halves.empty() || estimated_points(tree, box) <= place_points) return box;
        const bool second = estimated_points(tree, halves[1]) > estimated_points(tree, halves[0]);
        box = halves[second != (step == i)];
    }
}

double quantile(std::vector<double>& values, double share)
{
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

CloudSurvey survey_cloud(const ChosenPoints& points, const std::vector<Box3i>& places, Repeated repeated,
                         const std::function<void()>& check)
{
    std::vector<double> spacings, noises;
    SampleSettings settings;
    settings.level = points.tree().info().levels;
    // A cell of the grid's finest step has one position.
    const Vec3d& step_of_grid = points.tree().info().grid.scale;
    if (repeated == Repeated::once) settings.cell = *std::min_element(step_of_grid.begin(), step_of_grid.end());
    const std::size_t patches_per_place =
        std::min(most_patches, all_patches / std::max<std::size_t>(1, places.size()) + 1);
    for (const Box3i& place : places) {
        check();
        const SurfaceSample sample = sample_surface(points, place, settings);
        Patches patches(sample);
        const std::size_t step = std::max<std::size_t>(1, sample.size() / patches_per_place);
        for (std::size_t i = 0; i < sample.size(); i += step) {
            if (sample.spacing[i] > 0) spacings.push_back(sample.spacing[i] / 1.2);
            const double noise = noise_at(sample, patches.around(static_cast<std::uint32_t>(i), patch_sizes.back()));
            if (noise >= 0) noises.push_back(noise);
        }
    }
    CloudSurvey survey;
    survey.spacing = quantile(spacings, 0.5);
    const SurveyTuning& tuned = detect_tuning().survey;
    survey.noise = std::min(tuned.lower_factor * quantile(noises, tuned.lower_quantile),
                            tuned.upper_factor * quantile(noises, tuned.upper_quantile));
    survey.least_noise = quantile(noises, tuned.quiet_quantile);
    return survey;
}

CloudPart quiet_part(const ChosenPoints& points, const std::vector<Box3i>& regions, const std::vector<Box3i>& groups,
                     const CloudSurvey& whole, Repeated repeated, const std::function<void()>& check)
{
    if (regions.empty()) return {};
    const SurveyTuning& tuned = detect_tuning().survey;
    const double most = tuned.quiet_beside * whole.noise, dense = tuned.dense_beside * whole.spacing;
    std::vector<double> least(regions.size(), infinity);
    std::vector<bool> is_dense(regions.size(), false);
    // The densest place of each region, and others where one is quiet: then a region may be whose first one is a tree.
    for (std::size_t i = 0; i < places_per_region; ++i) {
        for (std::size_t r = 0; r < regions.size(); ++r) {
            if (least[r] < most) continue;
            CloudSurvey found = survey_cloud(points, {dense_place(points.tree(), regions[r], i)}, repeated, check);
            // Numbers of points of places are estimates: it may be empty.
            if (i == 0 && !(found.spacing > 0)) found = survey_cloud(points, {regions[r]}, repeated, check);
            if (found.least_noise > 0) least[r] = std::min(least[r], found.least_noise);
            is_dense[r] = is_dense[r] || (found.spacing > 0 && found.spacing < dense);
        }
        if (i == 0 && !(*std::min_element(least.begin(), least.end()) < tuned.quiet_share * whole.noise)) return {};
    }
    std::vector<std::uint8_t> quiet;
    for (std::size_t r = 0; r < regions.size(); ++r) quiet.push_back(least[r] < most || is_dense[r]);
    fill_groups(regions, groups, quiet);
    std::vector<Box3i> boxes;
    for (std::size_t r = 0; r < regions.size(); ++r)
        if (quiet[r]) boxes.push_back(regions[r]);
    return boxes.empty() || boxes.size() == regions.size() ? CloudPart() : CloudPart(std::move(boxes));
}

}  // namespace pcm
