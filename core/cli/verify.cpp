#include "tree/verify.h"

#include "cli/common.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
    unsigned threads = 0;
};

int verify(const Arguments& arguments)
{
    const VerifyReport report = verify_tree(arguments.tree, arguments.threads, console_progress(arguments.common));
    end_progress(arguments.common);
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.tree;
        put_outcome(json, report.outcome);
        json["bytes"] = report.bytes;
        json["position_error"] = report.position_error;
        json["faults"] = report.faults;
        std::printf("%s\n", json.dump(2).c_str());
    } else if (report.faults.empty()) {
        std::printf("%s: whole; %s points, each there once, in %.1f s (%.2f M points/s)\n", arguments.tree.c_str(),
                    grouped(report.outcome.points_out).c_str(), report.outcome.seconds,
                    points_per_second(report.outcome) / 1e6);
    } else {
        for (const std::string& fault : report.faults) std::printf("fault: %s\n", fault.c_str());
        std::printf("%s: %zu faults\n", arguments.tree.c_str(), report.faults.size());
    }
    return report.faults.empty() ? 0 : 1;
}

}  // namespace

void add_verify(CLI::App& app, int& result)
{
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        app.add_subcommand("verify", "Check a tree: checksums, counts, boxes, and that every point is there once");
    command->add_option("tree", arguments->tree, "Tree folder, or the index file in it")->required();
    command->add_option("-t,--threads", arguments->threads, "Threads (default: one a processor)");
    add_common(*command, arguments->common);
    command->callback([arguments, &result] { result = verify(*arguments); });
}

}  // namespace pcm::cli
