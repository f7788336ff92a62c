#include "pcm/tree/verify.h"

#include "pcm/cli/common.h"
#include "pcm/tree/damage.h"
#include "pcm/tree/verify_levels.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
    unsigned threads = 0;
    bool levels = false;
};

void print(const LevelsReport& report)
{
    std::printf("level          points     spacing  least distance  coverage  variation  isolated\n");
    for (std::size_t k = 0; k < report.levels.size(); ++k) {
        const LevelMeasure& level = report.levels[k];
        std::printf("%5zu %15s  %10s  %14.6f  %8.6f  %9.4f  %8s\n", k, grouped(level.points).c_str(),
                    brief(level.spacing).c_str(), level.least_distance, level.coverage, level.variation,
                    grouped(level.isolated).c_str());
    }
    std::printf("distances in units of the level's spacing; measured in %.1f s\n", report.seconds);
    if (std::isinf(report.coverage_limit))
        std::printf("points were deleted: coverage is not guaranteed until 'pcmlab compact'\n");
    else if (report.coverage_limit > 1)
        std::printf("points were appended: a coverage below %g is guaranteed, and below 1 after 'pcmlab compact'\n",
                    report.coverage_limit);
}

Json to_json(const LevelsReport& report)
{
    Json levels = Json::array();
    for (const LevelMeasure& level : report.levels)
        levels.push_back({{"points", level.points},
                          {"spacing", level.spacing},
                          {"least_distance", level.least_distance},
                          {"coverage", level.coverage},
                          {"variation", level.variation},
                          {"isolated", level.isolated}});
    return levels;
}

std::string count_of(std::size_t faults) { return grouped(faults) + (faults == 1 ? " fault" : " faults"); }

// The last line: what the tree is worth, and what to do where it is damaged.
std::string verdict(const std::string& tree, const VerifyReport& report, const LevelsReport& levels)
{
    const std::string points = grouped(report.outcome.points_out) + " points";
    const std::string command = repair_command(tree_folder_of(tree));
    if (!report.faults.empty())
        return "damaged, " + count_of(report.faults.size() + report.around.size()) +
               "; restore it from a copy, or keep what is undamaged, in a terminal: " + command;
    if (!report.around.empty())
        return "damaged, though none of its " + points + " is lost; repair it, in a terminal: " + command;
    if (!levels.faults.empty())
        return "its " + points + " are intact, its levels are not, " + count_of(levels.faults.size()) +
               "; 'pcmlab compact' makes the levels anew";
    char speed[64];
    std::snprintf(speed, sizeof speed, "in %.1f s (%.2f M points/s)", report.outcome.seconds,
                  points_per_second(report.outcome) / 1e6);
    return "intact; " + points + ", each stored once, " + speed;
}

int verify(const Arguments& arguments)
{
    const VerifyReport report = verify_tree(arguments.tree, arguments.threads, console_progress(arguments.common));
    LevelsReport levels;
    if (arguments.levels && report.faults.empty())
        levels = verify_levels(*Tree::open(arguments.tree), arguments.threads, console_progress(arguments.common));
    const bool intact = report.faults.empty() && report.around.empty() && levels.faults.empty();
    end_progress(arguments.common);
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.tree;
        put_outcome(json, report.outcome);
        json["intact"] = intact;
        json["bytes"] = report.bytes;
        json["position_error"] = report.position_error;
        if (arguments.levels) {
            json["levels"] = to_json(levels);
            json["coverage_limit"] = levels.coverage_limit;  // null: no guarantee
        }
        std::vector<std::string> faults = report.faults;
        faults.insert(faults.end(), levels.faults.begin(), levels.faults.end());
        json["faults"] = faults;
        json["around"] = report.around;
        json["notes"] = report.notes;
        print_json(json);
        return intact ? 0 : 1;
    }
    if (!levels.levels.empty()) print(levels);
    for (const std::string& note : report.notes) std::printf("note: %s\n", note.c_str());
    for (const auto& faults : {report.faults, report.around, levels.faults})
        for (const std::string& fault : faults) std::printf("fault: %s\n", fault.c_str());
    std::printf("%s: %s\n", arguments.tree.c_str(), verdict(arguments.tree, report, levels).c_str());
    return intact ? 0 : 1;
}

}  // namespace

Run add_verify(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    options.option("-t,--threads", arguments->threads, "Threads (default: one per processor)");
    options.flag("--levels", arguments->levels, "Also measure how evenly the levels are spaced: exact, but slower");
    add_common(options, arguments->common);
    return [arguments] { return verify(*arguments); };
}

}  // namespace pcm::cli
