#include "pcm/update/repair.h"

#include "pcm/cli/common.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
    RepairOptions options;
};

void print(const char* tree, const RepairReport& report, bool check)
{
    for (const std::string& fault : report.faults) std::printf("fault: %s\n", fault.c_str());
    for (const std::string& file : report.restored)
        std::printf("fault: %s; %s from the index\n", file.c_str(), check ? "can be restored" : "restored");
    for (const std::string& file : report.healed)
        std::printf("%s: left by an interrupted update, %s\n", file.c_str(), check ? "to be removed" : "removed");
    const std::string points = grouped(report.outcome.points_out);
    const char* const now = check ? "" : report.verified ? "; the tree was verified" : "; the tree is still damaged";
    if (report.whole())
        std::printf("%s: intact; %s points\n", tree, points.c_str());
    else if (!report.index_written)
        std::printf("%s: no point is lost; %s points%s\n", tree, points.c_str(), now);
    else
        std::printf("%s: %s from its chunks; %s points, %s lost%s\n", tree, check ? "can be rebuilt" : "rebuilt",
                    points.c_str(), grouped(report.points_lost).c_str(), now);
}

int repair(Arguments& arguments)
{
    arguments.options.progress = console_progress(arguments.common);
    const RepairReport report = repair_tree(arguments.tree, arguments.options);
    end_progress(arguments.common);
    const bool check = arguments.options.check_only;
    const int result = (check ? report.whole() : report.verified) ? 0 : 1;
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.tree;
        put_outcome(json, report.outcome);
        json["generation"] = report.generation;
        json["whole"] = report.whole();
        json["index_written"] = report.index_written && !check;
        json["points_lost"] = report.points_lost;
        json["verified"] = report.verified;
        json["faults"] = report.faults;
        json["restored"] = report.restored;
        json["leftovers"] = report.healed;
        print_json(json);
        return result ? result : finished(report.outcome);
    }
    print(arguments.tree.c_str(), report, check);
    return result ? result : finished(report.outcome);
}

}  // namespace

Run add_repair(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder").required();
    options.flag("--check", arguments->options.check_only, "Only report what is damaged and what could be recovered");
    options.option("-t,--threads", arguments->options.threads, "Threads (default: one per processor)");
    add_common(options, arguments->common);
    return [arguments] { return repair(*arguments); };
}

}  // namespace pcm::cli
