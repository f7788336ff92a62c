#include "pcm/filter/outliers.h"

#include "pcm/cli/attribute_options.h"

#include <cstdio>
#include <map>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree, method = "statistical";
    TargetOptions target;
    std::uint32_t neighbours = 16;
    std::uint64_t memory = std::uint64_t(512) << 20;
    std::uint32_t threads = 0;
    std::optional<double> radius;
    bool flann = false;
    OutlierOptions options;
};

const std::map<std::string, OutlierMethod> methods{
    {"statistical", OutlierMethod::statistical}, {"robust", OutlierMethod::robust}, {"radius", OutlierMethod::radius}};

void print(const Arguments& arguments, const OutlierReport& report, const std::string& tree)
{
    const OutlierOptions& options = arguments.options;
    for (const std::string& note : report.notes) std::printf("note: %s\n", note.c_str());
    const char* done = options.count_only ? "would be removed" : options.label ? "labelled" : "removed";
    std::printf("%s: %s of %s points %s in %.1f s, peak memory %s\n", tree.c_str(), grouped(report.outliers).c_str(),
                grouped(report.outcome.points_in).c_str(), done, report.outcome.seconds,
                bytes_text(report.peak_memory_bytes).c_str());
    if (options.method != OutlierMethod::radius)
        std::printf("mean distance to %zu neighbours: %s %s, deviation %s, outliers above %s source units\n",
                    options.neighbours, options.method == OutlierMethod::robust ? "median" : "mean",
                    brief(report.centre).c_str(), brief(report.deviation).c_str(), brief(report.threshold).c_str());
    if (!report.coverage_kept)
        std::printf("note: coarse levels have gaps where points were removed; 'pcmlab compact' closes them\n");
}

int run(Arguments& arguments)
{
    OutlierOptions& options = arguments.options;
    options.method = methods.at(arguments.method);
    if (options.method == OutlierMethod::radius && !arguments.radius)
        throw UsageError("--method radius needs --radius, within which neighbours are counted");
    if (options.method != OutlierMethod::radius && arguments.radius)
        throw UsageError("--radius is for --method radius alone");
    options.radius = arguments.radius.value_or(0);
    options.neighbours = arguments.neighbours;
    options.overwrite = arguments.target.overwrite;
    keep_memory_limit(arguments.memory, least_filter_memory);
    options.memory_bytes = arguments.memory;
    options.threads = arguments.threads;
    options.backend = arguments.flann ? NeighbourBackend::flann : NeighbourBackend::own;
    options.progress = console_progress(arguments.common);
    OutlierReport report;
    std::string tree = arguments.tree;
    if (options.count_only) {
        report = remove_outliers(tree, options);
    } else {
        UpdateTarget target(arguments.tree, arguments.target.get());
        tree = target.path().string();
        report = target.update([&](const std::filesystem::path& folder) { return remove_outliers(folder, options); });
    }
    note_memory(report, options.memory_bytes);
    end_progress(arguments.common);
    if (!arguments.common.json) {
        print(arguments, report, tree);
        return finished(report.outcome);
    }
    Json json;
    json["tree"] = tree;
    put_report(json, report);
    json["outliers"] = report.outliers;
    json["done"] = !options.count_only;
    json["method"] = arguments.method;
    json["centre"] = report.centre;
    json["deviation"] = report.deviation;
    json["threshold"] = report.threshold;
    json["levels_as_even_as_before"] = report.coverage_kept;
    print_json(json);
    return finished(report.outcome);
}

}  // namespace

Run add_outliers(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    arguments->target.add_to(options);
    arguments->target.add_overwrite(options, "outlier, of --label,");
    options.flag("--count", arguments->options.count_only, "Only report how many points would be removed");
    options.flag("--label", arguments->options.label,
                 "Remove nothing: write the attribute outlier, 1 for outliers and 0 for others");
    options
        .option("--method", arguments->method,
                "statistical: mean distance to the neighbours above mean + factor * deviation of all points; robust: "
                "above median + factor * 1.4826 * MAD; radius: fewer neighbours than -k within --radius (default "
                "statistical)")
        .one_of({"statistical", "robust", "radius"});
    options.option("-k,--neighbours", arguments->neighbours, "Number of neighbours (default 16)").between(1, 1024);
    options.option("-a,--factor", arguments->options.factor, "Factor of the deviation, more than 0 (default 3)");
    options.option("--radius", arguments->radius, "Radius of the method radius, source units").positive();
    options.option("-m,--memory", arguments->memory, "Memory limit, e.g. 64M (the least) or 2G (default 512M)").bytes();
    options.option("-t,--threads", arguments->threads, "Threads (default: one per processor)");
    options.flag("--flann", arguments->flann, "Search with the FLANN library, for comparison");
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
