#include "bench/detect/truth.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

namespace pcm::bench {
namespace {

using Json = nlohmann::json;

struct Errors {
    double position = 0, angle = 0, radius = 0;        // source units and radians
    double position_s = 0, angle_s = 0, radius_s = 0;  // in standard deviations
    double worst() const { return std::max({position_s, angle_s, radius_s}); }
};

// At the middle of the inliers, which is the point of the found shape.
Errors errors_of(const ShapeFit& fit, const Shape& truth)
{
    Errors e;
    const Shape& shape = fit.shape;
    const Vec3d d = shape.point - truth.point;
    const auto angle = [&] { return length(cross(shape.axis, truth.axis)); };
    if (shape.kind == ShapeKind::plane) {
        e.position = std::fabs(dot(d, truth.axis));
        e.angle = angle();
    } else if (shape.kind == ShapeKind::cylinder) {
        e.position = length(d - dot(d, truth.axis) * truth.axis);
        e.angle = angle();
        e.radius = std::fabs(shape.radius - truth.radius);
    } else {
        e.position = length(d);
        e.radius = std::fabs(shape.radius - truth.radius);
    }
    const auto ratio = [](double error, double sigma) { return error == 0 ? 0 : error / sigma; };
    e.position_s = ratio(e.position, fit.errors.position);
    e.angle_s = ratio(e.angle, fit.errors.angle);
    e.radius_s = ratio(e.radius, fit.errors.radius);
    return e;
}

// How far the found shape is from the true one at the middle of the true one.
double offset_at(const Shape& shape, const Shape& truth)
{
    const Vec3d d = truth.point - shape.point;
    if (shape.kind == ShapeKind::plane) return std::fabs(dot(d, shape.axis));
    return shape.kind == ShapeKind::sphere ? length(d) : length(d - dot(d, shape.axis) * shape.axis);
}

// The true primitive that most points of a label come from, and how many they are.
std::pair<std::uint32_t, std::uint64_t> largest_of(const Pairs& pairs, std::uint32_t label)
{
    std::pair<std::uint32_t, std::uint64_t> largest{0, 0};
    for (auto at = pairs.lower_bound({label, 0}); at != pairs.end() && at->first.first == label; ++at)
        if (at->second > largest.second) largest = {at->first.second, at->second};
    return largest;
}

using Long = unsigned long long;

// Adds a found primitive to the score; returns the true one that it is, 0 if it is not one.
std::uint32_t judge(const Primitive& p, const std::vector<True>& truth, const Pairs& pairs, bool list, Score& score)
{
    const auto [best, most] = largest_of(pairs, p.label);
    const bool good = p.fit.verdict == FitVerdict::good;
    const ShapeKind kind = p.fit.shape.kind;
    if (best == 0) {
        ++score.clutter;
        score.good_clutter += good;
        score.clutter_points += p.points;
        if (list) std::printf("  in ground and trees: %s, %llu points\n", text_of(p.fit.shape).c_str(), Long(p.points));
        return 0;
    }
    ++score.found[kind];
    if (truth[best].shape.kind != kind) {
        ++score.wrong[kind];
        if (list)
            std::printf("  false: %s, %llu points (%llu of true %s %u)\n", text_of(p.fit.shape).c_str(), Long(p.points),
                        Long(most), traits_of(truth[best].shape.kind).name, best);
        return 0;
    }
    const Errors e = errors_of(p.fit, truth[best].shape);
    score.worst.push_back(e.worst());
    score.positions.push_back(offset_at(p.fit.shape, truth[best].shape));
    ++score.good;
    score.within += e.worst() <= 3;
    if (list)
        std::printf(
            "  %s %u: %llu of %llu points, noise %.2f mm, position %.4f mm (%.1f s), angle %.1e (%.1f s), "
            "radius %.4f mm (%.1f s)%s\n",
            traits_of(kind).name, best, Long(p.points), Long(truth[best].points), p.fit.noise * 1e3, e.position * 1e3,
            e.position_s, e.angle, e.angle_s, e.radius * 1e3, e.radius_s, good ? "" : " doubtful");
    return best;
}

}  // namespace

std::vector<True> read_truth(const std::filesystem::path& file)
{
    std::vector<True> truth(1);  // 0: ground and trees
    const Json json = Json::parse(std::ifstream(file));
    for (const Json& entry : json.at("primitives")) {
        True one;
        one.shape.kind = *shape_kind(entry.at("kind").get<std::string>());
        one.shape.point = entry.at("point").get<Vec3d>();
        one.shape.axis = entry.at("direction").get<Vec3d>();
        one.shape.radius = entry.at("radius");
        one.points = entry.at("points");
        truth.push_back(one);
    }
    return truth;
}

Score compare(std::vector<True> truth, const std::vector<Primitive>& primitives, const Pairs& pairs,
              std::uint64_t least, bool list)
{
    Score score;
    for (True& one : truth) one.points = 0;
    for (const auto& [pair, points] : pairs) truth.at(pair.second).points += points;
    std::vector<std::vector<std::uint32_t>> found_by(truth.size());
    for (const Primitive& p : primitives) found_by[judge(p, truth, pairs, list, score)].push_back(p.label);
    for (std::uint32_t t = 1; t < truth.size(); ++t) {
        if (truth[t].points <= least) continue;
        ++score.wanted[truth[t].shape.kind];
        std::uint64_t has = 0, best = 0;
        for (const std::uint32_t label : found_by[t]) {
            const auto at = pairs.find({label, t});
            has += at->second;
            best = std::max(best, at->second);
        }
        const bool recalled = 2 * best >= truth[t].points;
        score.recalled[truth[t].shape.kind] += recalled;
        score.split += found_by[t].size() > 1;
        if (!recalled && list)
            std::printf("  missed: %s of true %s %u; %llu of %llu points in %zu primitives\n",
                        text_of(truth[t].shape).c_str(), traits_of(truth[t].shape.kind).name, t, Long(has),
                        Long(truth[t].points), found_by[t].size());
    }
    return score;
}

void print(Score& score)
{
    const auto of = [](std::map<ShapeKind, int>& numbers, ShapeKind kind) { return numbers[kind]; };
    int wanted = 0, recalled = 0, found = 0, wrong = 0;
    for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere}) {
        std::printf("%-9s %d of %d found; %d false of %d\n", traits_of(kind).name, of(score.recalled, kind),
                    of(score.wanted, kind), of(score.wrong, kind), of(score.found, kind));
        wanted += of(score.wanted, kind), recalled += of(score.recalled, kind);
        found += of(score.found, kind), wrong += of(score.wrong, kind);
    }
    std::sort(score.worst.begin(), score.worst.end());
    const auto quantile = [&](double q) {
        return score.worst.empty() ? 0.0 : score.worst[static_cast<std::size_t>(q * double(score.worst.size() - 1))];
    };
    std::printf("recall %.1f %%, false %.1f %%, true ones in several pieces %d\n",
                100.0 * recalled / std::max(1, wanted), 100.0 * wrong / std::max(1, found), score.split);
    if (score.has_sigmas)
        std::printf(
            "within 3 sigma: %d of %d (%.1f %%); worst number of each in sigma: median %.2f, 90 %% %.2f, largest "
            "%.2f\n",
            score.within, score.good, 100.0 * score.within / std::max(1, score.good), quantile(0.5), quantile(0.9),
            quantile(1));
    std::printf("in ground and trees: %d primitives (%d of them good), %llu points\n", score.clutter,
                score.good_clutter, static_cast<unsigned long long>(score.clutter_points));
    std::sort(score.positions.begin(), score.positions.end());
    if (!score.positions.empty())
        std::printf("position error: median %.4f mm, 90 %% %.4f mm\n",
                    1e3 * score.positions[score.positions.size() / 2],
                    1e3 * score.positions[score.positions.size() * 9 / 10]);
}

}  // namespace pcm::bench
