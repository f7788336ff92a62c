// Detects the primitives of a generated site and compares them with its exact truth: recall, false ones, errors in
// standard deviations, time and memory. See README.md.
//
// A found primitive is the true one (of its kind) that most of its points come from. A true one is found when a found
// one is it, and has at least half of its points; a found one is false when most of its points come from the site, but
// not from a primitive of its kind. Primitives in the ground and in trees are counted by themselves.
#include "pcm/primitives/detect.h"
#include "pcm/primitives/point_labels.h"
#include "pcm/system/peak_memory.h"
#include "pcm/tree/tree.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace {

using namespace pcm;
using Json = nlohmann::json;

struct True {
    Shape shape;
    std::uint64_t points = 0;
};

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

// Points by label and true primitive.
std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> count_pairs(const Tree& tree,
                                                                             const DetectReport& found)
{
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> pairs;
    const std::size_t source = *tree.info().schema.find("point_source_id");
    ColumnSet columns;
    columns.positions = false;
    columns.attributes.set(source);
    for (NodeId node = 0; node < tree.nodes().size(); ++node) {
        const Chunk chunk = tree.read_chunk(node, columns);
        const std::vector<std::uint32_t> labels = found.labels->get(node);
        for (std::size_t i = 0; i < chunk.points; ++i)
            ++pairs[{labels[i], static_cast<std::uint32_t>(chunk.attributes[source]->value(i, 0))}];
    }
    return pairs;
}

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

struct Score {
    std::map<ShapeKind, int> wanted, recalled, found, wrong;
    int clutter = 0, good_clutter = 0, split = 0;
    int good = 0, within = 0;
    std::uint64_t clutter_points = 0;
    std::vector<double> worst;
};

using Pairs = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t>;

// The true primitive that most points of a label come from, and how many they are.
std::pair<std::uint32_t, std::uint64_t> largest_of(const Pairs& pairs, std::uint32_t label)
{
    std::pair<std::uint32_t, std::uint64_t> largest{0, 0};
    for (auto at = pairs.lower_bound({label, 0}); at != pairs.end() && at->first.first == label; ++at)
        if (at->second > largest.second) largest = {at->first.second, at->second};
    return largest;
}

using Long = unsigned long long;

// Adds a found primitive to the score; returns the true one that it is, 0 if it is none.
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

Score compare(const std::vector<True>& truth, const DetectReport& report, const Pairs& pairs, std::uint64_t least,
              bool list)
{
    Score score;
    std::vector<std::vector<std::uint32_t>> found_by(truth.size());
    for (const Primitive& p : report.primitives) found_by[judge(p, truth, pairs, list, score)].push_back(p.label);
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

void print(const Tree& tree, const DetectReport& report, Score& score)
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
    std::printf(
        "within 3 sigma: %d of %d (%.1f %%); worst number of each in sigma: median %.2f, 90 %% %.2f, largest %.2f\n",
        score.within, score.good, 100.0 * score.within / std::max(1, score.good), quantile(0.5), quantile(0.9),
        quantile(1));
    std::printf("in ground and trees: %d primitives (%d of them good), %llu points\n", score.clutter,
                score.good_clutter, static_cast<unsigned long long>(score.clutter_points));
    for (const std::string& note : report.notes) std::printf("note: %s\n", note.c_str());
    std::printf("%llu points, threshold %.2f mm, sample %.1f mm, %.1f s, peak memory %.0f MB\n",
                static_cast<unsigned long long>(tree.info().points), report.threshold * 1e3, report.sample * 1e3,
                report.outcome.seconds, static_cast<double>(peak_memory_bytes()) / 1e6);
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Detection of primitives against the exact truth of a generated site");
    std::string tree_path, truth_path;
    DetectOptions options;
    bool list = false;
    app.add_option("tree", tree_path, "Tree of a generated site")->required();
    app.add_option("--truth", truth_path, "Its .truth.json (default: beside the tree)");
    app.add_option("--threshold", options.threshold);
    app.add_option("--min-points", options.least_points);
    app.add_option("--seed", options.seed);
    app.add_option("-t,--threads", options.threads);
    app.add_option("-m,--memory", options.memory_bytes)->transform(CLI::AsSizeValue(false));
    app.add_flag("--list", list, "Each primitive");
    CLI11_PARSE(app, argc, argv);
    try {
        const auto tree = Tree::open(tree_path);
        if (truth_path.empty())
            truth_path = std::filesystem::path(tree->folder()).replace_extension(".truth.json").string();
        const std::vector<True> truth = read_truth(truth_path);
        const DetectReport report = detect_primitives(tree, options);
        Score score = compare(truth, report, count_pairs(*tree, report), options.least_points, list);
        print(*tree, report, score);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_detect: %s\n", error.what());
        return 1;
    }
    return 0;
}
