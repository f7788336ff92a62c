#include "bench/fit/verdict_scenes.h"

#include "pcm/cloud/numbers.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <utility>

namespace pcm::bench {
namespace {

constexpr double given_threshold = 0.015;  // m, three standard deviations
constexpr double clear_error = 0.0017;     // m

class Scenes {
public:
    explicit Scenes(std::uint64_t seed) { options_.seed = seed; }

    // `asked`: the kind that is fitted; `threshold`: 0 for the automatic one.
    void add(const FitSceneOptions& options, ShapeKind asked, double threshold)
    {
        VerdictScene next;
        FitSceneOptions scene = options;
        scene.seed = options_.seed * 1000 + scenes_.size();
        next.scene = make_scene(scene);
        next.asked.kind = asked;
        next.asked.threshold = threshold;
        next.asked.seed = scene.seed;
        next.oracle = error_of(next.scene, oracle(next.scene)).surface;
        scenes_.push_back(std::move(next));
    }
    FitSceneOptions base(ShapeKind kind, std::size_t points, double outliers) const
    {
        FitSceneOptions options = options_;
        options.kind = kind;
        options.points = points;
        options.outliers = outliers;
        options.with_normals = false;
        return options;
    }
    std::vector<VerdictScene> take() { return std::move(scenes_); }

private:
    FitSceneOptions options_;
    std::vector<VerdictScene> scenes_;
};

const ShapeKind kinds[] = {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere, ShapeKind::cone};

std::vector<VerdictScene> scenes_of(std::uint64_t seed)
{
    Scenes scenes(seed);
    for (const ShapeKind kind : kinds) {
        for (const double outliers : {0.3, 0.6, 0.8})
            for (const std::size_t points : {100, 300, 1000}) scenes.add(scenes.base(kind, points, outliers), kind, 0);
        for (const std::size_t points : {100, 300, 1000}) scenes.add(scenes.base(kind, points, 0.97), kind, 0);
    }
    for (const double threshold : {0.0, given_threshold}) {
        for (const double degrees : {60, 30, 15, 8}) {
            FitSceneOptions arc = scenes.base(ShapeKind::cylinder, 1000, 0.3);
            arc.arc = degrees * pi / 180;
            scenes.add(arc, ShapeKind::cylinder, threshold);
        }
        for (const double patch : {0.4, 0.2, 0.1}) {
            FitSceneOptions part = scenes.base(ShapeKind::sphere, 1000, 0.3);
            part.patch = patch;
            scenes.add(part, ShapeKind::sphere, threshold);
        }
    }
    for (const ShapeKind kind : kinds)
        for (const ShapeKind other : kinds)
            if (kind != other) scenes.add(scenes.base(kind, 1000, 0.3), other, 0);
    return scenes.take();
}

}  // namespace

std::vector<VerdictScene> verdict_scenes(std::uint64_t first, std::uint64_t seeds)
{
    std::vector<VerdictScene> all;
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
        std::vector<VerdictScene> some = scenes_of(seed);
        std::move(some.begin(), some.end(), std::back_inserter(all));
    }
    return all;
}

Verdicts judge(const std::vector<VerdictScene>& scenes)
{
    Verdicts verdicts;
    std::vector<double> errors;
    for (const VerdictScene& next : scenes) {
        const ShapeFit fit = fit_shape(next.scene.points, next.asked);
        const bool good = fit.verdict == FitVerdict::good;
        const double error = fit.has_shape() ? error_of(next.scene, fit.shape).surface : infinity;
        const bool right = next.asked.kind == next.scene.truth.kind && error <= 3 * std::max(next.oracle, clear_error);
        ++(right ? (good ? verdicts.right_good : verdicts.right_doubtful)
                 : (good ? verdicts.wrong_good : verdicts.wrong_doubtful));
        if (right) errors.push_back(error / next.oracle);
    }
    if (errors.empty()) return verdicts;
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    verdicts.error = *middle;
    return verdicts;
}

std::vector<std::string> heads_of_verdicts()
{
    return {"right and good", "right, doubtful", "wrong and good", "wrong, doubtful or refused", "error × oracle"};
}

std::vector<std::string> cells_of(const Verdicts& verdicts)
{
    char error[32];
    std::snprintf(error, sizeof(error), "%.3f", verdicts.error);
    return {std::to_string(verdicts.right_good), std::to_string(verdicts.right_doubtful),
            std::to_string(verdicts.wrong_good), std::to_string(verdicts.wrong_doubtful), error};
}

}  // namespace pcm::bench
