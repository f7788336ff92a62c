// A tree's index is rebuilt from its chunks.
#include "pcm/update/repair.h"

#include "pcm/ops/shared/target_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/text.h"

namespace pcm::ops {
namespace {

class Repair : public Operation {
public:
    Repair()
    {
        target_.declare_tree(arguments_);
        arguments_.find("tree")->help("Tree folder");
        arguments_.add("check", options_.check_only)
            .label("Check only")
            .help("Only report what is damaged and what could be recovered");
        work_.declare_threads(arguments_);
    }

    Result answer(const Context& context) override
    {
        options_.threads = work_.threads;
        options_.progress = context.progress;
        const RepairReport report = repair_tree(target_.tree, options_);
        const bool check = options_.check_only;
        Result result;
        result.input = {target_.tree};
        if (!check) {
            result.output = target_.tree;
            result.makes = Makes::changed;
        }
        result.good = check ? report.whole() : report.verified;
        result.outcome = report.outcome;
        result.accuracy = exact_answer();
        Json& values = result.values;
        values["generation"] = report.generation;
        values["whole"] = report.whole();
        values["index_written"] = report.index_written && !check;
        values["points_lost"] = report.points_lost;
        values["verified"] = report.verified;
        values["faults"] = report.faults;
        values["restored"] = report.restored;
        values["leftovers"] = report.healed;
        write_lines(result, report, check);
        return result;
    }

private:
    void write_lines(Result& result, const RepairReport& report, bool check) const
    {
        for (const std::string& fault : report.faults) result.line("fault: " + fault);
        for (const std::string& file : report.restored)
            result.line("fault: " + file + "; " + (check ? "can be restored" : "restored") + " from the index");
        for (const std::string& file : report.healed)
            result.line(file + ": left by an interrupted update, " + (check ? "to be removed" : "removed"));
        const std::string points = points_text(report.outcome.points_out);
        const std::string now = check             ? ""
                                : report.verified ? "; the tree was verified"
                                                  : "; the tree is still damaged";
        if (report.whole())
            result.line(target_.tree + ": intact; " + points);
        else if (!report.index_written)
            result.line(target_.tree + ": no point is lost; " + points + now);
        else
            result.line(target_.tree + ": " + (check ? "can be rebuilt" : "rebuilt") + " from its chunks; " + points +
                        ", " + grouped(report.points_lost) + " lost" + now);
    }

    TargetArguments target_;
    WorkArguments work_;
    RepairOptions options_;
};

}  // namespace

Row repair_row()
{
    return {"repair",
            nullptr,
            "Rebuild a tree's index from its chunks, without damaged chunks",
            "Rebuilds the index of a damaged tree from its chunks, without those that are damaged, and removes what "
            "interrupted updates have left.",
            0,
            nullptr,
            {{"generation", "count", "", "generation of the tree afterwards"},
             {"whole", "flag", "", "true: nothing was damaged"},
             {"index_written", "flag", "", "the index was rebuilt"},
             {"points_lost", "count", "points", "points of damaged chunks"},
             {"verified", "flag", "", "the tree was verified afterwards, and is intact"},
             {"faults", "list", "", "what was damaged"},
             {"restored", "list", "", "files that the index restores"},
             {"leftovers", "list", "", "files left by interrupted updates"}},
            make<Repair>,
            {},
            always_exact};
}

}  // namespace pcm::ops
