// Detects the primitives of a generated site and compares them with its exact truth: recall, false ones, errors in
// standard deviations, time and memory. See README.md.
//
// A found primitive is the true one (of its kind) that most of its points come from. A true one is found when a found
// one is it, and has at least half of its points; a found one is false when most of its points come from the site, but
// not from a primitive of its kind. Primitives in the ground and in trees are counted by themselves.
#include "pcm/detect/detect.h"

#include "bench/detect/truth.h"
#include "bench/sweep/sweep.h"
#include "pcm/detect/point_labels.h"
#include "pcm/system/peak_memory.h"
#include "pcm/tree/tree.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::bench;

Pairs count_pairs(const Tree& tree, const DetectReport& found)
{
    Pairs pairs;
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

// A row of a sweep.
std::vector<std::string> figures(const std::shared_ptr<const Tree>& tree, const std::vector<True>& truth,
                                 const DetectOptions& options)
{
    const DetectReport report = detect_primitives(tree, options);
    const Score score = compare(truth, report.primitives, count_pairs(*tree, report), options.least_points, false);
    int wanted = 0, recalled = 0, found = 0, wrong = 0;
    for (const auto& [kind, count] : score.wanted) wanted += count;
    for (const auto& [kind, count] : score.recalled) recalled += count;
    for (const auto& [kind, count] : score.found) found += count;
    for (const auto& [kind, count] : score.wrong) wrong += count;
    const auto part = [](int some, int all) { return std::to_string(some) + " of " + std::to_string(all); };
    return {part(recalled, wanted), part(wrong, found), std::to_string(score.split), part(score.within, score.good),
            std::to_string(score.clutter) + ", good " + std::to_string(score.good_clutter)};
}

// `wanted`: true primitives of more points than these are asked for.
void run(const std::shared_ptr<const Tree>& tree, const std::vector<True>& truth, const DetectOptions& options,
         std::uint64_t wanted, bool list)
{
    const std::clock_t start = std::clock();
    const DetectReport report = detect_primitives(tree, options);
    const double processor = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    Score score = compare(truth, report.primitives, count_pairs(*tree, report), wanted, list);
    print(score);
    for (const std::string& note : report.notes) std::printf("note: %s\n", note.c_str());
    std::printf("%llu points, threshold %.2f mm, sample %.1f mm, %.1f s (processor time %.3f s), peak memory %.0f MB\n",
                static_cast<unsigned long long>(tree->info().points), report.threshold * 1e3, report.sample * 1e3,
                report.outcome.seconds, processor, static_cast<double>(peak_memory_bytes()) / 1e6);
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Detection of primitives against the exact truth of a generated site");
    std::string tree_path, truth_path;
    std::vector<std::string> sweeps;
    DetectOptions options;
    std::uint64_t wanted = 0;
    bool list = false;
    app.add_option("tree", tree_path, "Tree of a generated site");
    app.add_option("--truth", truth_path, "Its .truth.json (default: next to the tree)");
    app.add_option("--threshold", options.threshold);
    app.add_option("--min-points", options.least_points);
    app.add_option("--step", options.step, "Points farther apart are not of one primitive; 0: as the spacing allows");
    app.add_option("--wanted", wanted, "True primitives of more points are asked for (default: those of --min-points)");
    app.add_option("--seed", options.seed);
    app.add_option("-t,--threads", options.threads);
    app.add_option("-m,--memory", options.memory_bytes)->transform(CLI::AsSizeValue(false));
    app.add_flag("--list", list, "Each primitive");
    app.add_option("--sweep", sweeps, "Tuned values: NAME or NAME=FROM:TO:STEPS; 'list' prints the names");
    CLI11_PARSE(app, argc, argv);
    try {
        const std::vector<Sweep> drawn = read_sweeps(sweeps);
        if (!sweeps.empty() && drawn.empty()) return 0;
        const auto tree = Tree::open(tree_path);
        if (truth_path.empty())
            truth_path = std::filesystem::path(tree->folder()).replace_extension(".truth.json").string();
        const std::vector<True> truth = read_truth(truth_path);
        if (drawn.empty()) run(tree, truth, options, wanted > 0 ? wanted : options.least_points, list);
        for (const Sweep& sweep : drawn)
            print_sweep(sweep, {"found", "false", "in several pieces", "within 3 sigma", "in ground and trees"},
                        [&] { return figures(tree, truth, options); });
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_detect: %s\n", error.what());
        return 1;
    }
    return 0;
}
