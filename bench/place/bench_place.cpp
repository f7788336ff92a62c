// Fits at places that are clicked on generated sites, against their exact truth: right and wrong answers, good and
// doubtful ones. See README.md.
#include "bench/place/clicks.h"
#include "bench/sweep/sweep.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace pcm::bench;

std::vector<std::string> figures(const std::vector<ClickedSite>& sites, bool list)
{
    ClickedSite::Counts sum;
    for (const ClickedSite& site : sites) site.judge(list, sum);
    std::vector<std::string> cells;
    for (const int count : {sum.right_good, sum.right_doubtful, sum.wrong_good, sum.wrong_doubtful, sum.clutter_good})
        cells.push_back(std::to_string(count));
    return cells;
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Clicks on generated sites against their exact truth");
    std::vector<std::string> trees, sweeps;
    std::size_t clicks = 60;
    std::uint64_t seed = 1;
    bool list = false;
    app.add_option("trees", trees, "Trees of generated sites, each with its .truth.json next to it");
    app.add_option("--clicks", clicks, "On primitives of each site; a third as many are on ground and trees");
    app.add_option("--seed", seed, "Seed of the places");
    app.add_option("--sweep", sweeps, "Tuned values: NAME or NAME=FROM:TO:STEPS; 'list' prints the names");
    app.add_flag("--list", list, "Each click");
    CLI11_PARSE(app, argc, argv);
    try {
        const std::vector<Sweep> drawn = read_sweeps(sweeps);
        if (!sweeps.empty() && drawn.empty()) return 0;
        if (trees.empty()) throw std::invalid_argument("no tree was given");
        std::vector<ClickedSite> sites;
        for (const std::string& tree : trees) sites.emplace_back(tree, clicks, seed);
        const std::vector<std::string> heads{"right and good", "right, doubtful", "wrong and good",
                                             "wrong, doubtful or refused", "good on ground and trees"};
        for (const Sweep& sweep : drawn) print_sweep(sweep, heads, [&] { return figures(sites, false); });
        if (!drawn.empty()) return 0;
        const std::vector<std::string> cells = figures(sites, list);
        for (std::size_t k = 0; k < heads.size(); ++k) std::printf("%s: %s\n", heads[k].c_str(), cells[k].c_str());
        return 0;
    } catch (const std::exception& failure) {
        std::fprintf(stderr, "bench_place: %s\n", failure.what());
        return 1;
    }
}
