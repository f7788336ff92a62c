// A tree is checked.
#include "pcm/tree/verify.h"

#include "pcm/cluster/team_verify.h"
#include "pcm/ops/shared/target_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/text.h"
#include "pcm/threads/team.h"
#include "pcm/tree/damage.h"
#include "pcm/tree/verify_levels.h"

#include <cmath>

namespace pcm::ops {
namespace {

void write_levels(Result& result, const LevelsReport& report)
{
    result.line("level          points     spacing  least distance  coverage  variation  isolated");
    for (std::size_t k = 0; k < report.levels.size(); ++k) {
        const LevelMeasure& level = report.levels[k];
        result.print("%5zu %15s  %10s  %14.6f  %8.6f  %9.4f  %8s", k, grouped(level.points).c_str(),
                     brief(level.spacing).c_str(), level.least_distance, level.coverage, level.variation,
                     grouped(level.isolated).c_str());
    }
    result.print("distances in units of the level's spacing; measured in %.1f s", report.seconds);
    if (std::isinf(report.coverage_limit))
        result.line("points were deleted: coverage is not guaranteed until 'pcmlab compact'");
    else if (report.coverage_limit > 1)
        result.print("points were appended: a coverage below %g is guaranteed, and below 1 after 'pcmlab compact'",
                     report.coverage_limit);
}

Json json_of_levels(const LevelsReport& report)
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
    const std::string points = points_text(report.outcome.points_out);
    const std::string command = repair_command(tree_folder_of(tree));
    if (!report.faults.empty())
        return "damaged, " + count_of(report.faults.size() + report.around.size()) +
               "; restore it from a copy, or keep what is undamaged, in a terminal: " + command;
    if (!report.around.empty())
        return "damaged, though none of its " + points + " is lost; repair it, in a terminal: " + command;
    if (!levels.faults.empty())
        return "its " + points + " are intact, its levels are not, " + count_of(levels.faults.size()) +
               "; 'pcmlab compact' makes the levels again";
    char speed[64];
    std::snprintf(speed, sizeof speed, "in %.1f s (%.2f M points/s)", report.outcome.seconds,
                  points_per_second(report.outcome) / 1e6);
    return "intact; " + points + ", each stored once, " + speed;
}

class Verify : public Operation {
public:
    Verify()
    {
        target_.declare_tree(arguments_);
        work_.declare_threads(arguments_);
        arguments_.add("levels", measures_levels_)
            .label("Levels too")
            .help("Also measure how evenly the levels are spaced: exact, but slower");
    }

    Result answer(const Context& context) override
    {
        const ProgressFunction first = measures_levels_ ? part_of(context.progress, 0, 0.5) : context.progress;
        const VerifyReport report = context.team ? verify_tree_by(*context.team, target_.tree, work_.threads, first)
                                                 : verify_tree(target_.tree, work_.threads, first);
        LevelsReport levels;  // one process measures them
        if (measures_levels_ && report.faults.empty() && (!context.team || context.team->rank() == 0))
            levels = verify_levels(*Tree::open(target_.tree), work_.threads, part_of(context.progress, 0.5, 1));
        Result result;
        result.input = {target_.tree};
        result.outcome = report.outcome;
        result.accuracy = exact_answer();
        result.notes = report.notes;
        result.good = report.faults.empty() && report.around.empty() && levels.faults.empty();
        Json& values = result.values;
        values["intact"] = result.good;
        values["bytes"] = report.bytes;
        values["position_error"] = report.position_error;
        values["levels"] = measures_levels_ ? json_of_levels(levels) : Json();
        values["coverage_limit"] =
            measures_levels_ && std::isfinite(levels.coverage_limit) ? Json(levels.coverage_limit) : Json();
        std::vector<std::string> faults = report.faults;
        faults.insert(faults.end(), levels.faults.begin(), levels.faults.end());
        values["faults"] = faults;
        values["around"] = report.around;
        if (!levels.levels.empty()) write_levels(result, levels);
        for (const auto& list : {report.faults, report.around, levels.faults})
            for (const std::string& fault : list) result.line("fault: " + fault);
        result.line(target_.tree + ": " + verdict(target_.tree, report, levels));
        return result;
    }

private:
    TargetArguments target_;
    WorkArguments work_;
    bool measures_levels_ = false;
};

}  // namespace

Row verify_row()
{
    return {
        "verify",
        nullptr,
        "Check a tree: checksums, counts, boxes, and that every point is stored exactly once",
        "Reads all of a tree and checks it: checksums, counts, boxes, and that every point is stored exactly once; "
        "and, with --levels, how evenly its levels are spaced.",
        0,
        nullptr,
        {{"intact", "flag", "", "nothing is wrong"},
         {"bytes", "count", "bytes", "size of the tree"},
         {"position_error", "number", "source units", "largest position error"},
         {"levels", "list?", "", "points, spacing, least_distance, coverage, variation, isolated; null: not requested"},
         {"coverage_limit", "number?", "", "guaranteed coverage; null: none, or not requested"},
         {"faults", "list", "", "what is wrong"},
         {"around", "list", "", "what is wrong around the tree's own files"}},
        make<Verify>,
        {},
        always_exact};
}

}  // namespace pcm::ops
