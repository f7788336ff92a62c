#include "pcm/build/build_then.h"
#include "pcm/cli/attribute_options.h"
#include "pcm/cli/common.h"
#include "pcm/cli/reading.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    ReadingOptions reading;
    std::vector<std::string> inputs;
    std::string output;
    std::uint64_t memory = std::uint64_t(1) << 30;
    bool fast = false;
    std::uint32_t normals = 0;  // of how many neighbours; 0: none
    BuildOptions options;
};

void put_build(Json& json, const BuildReport& report)
{
    put_outcome(json, report.outcome);
    json["points_skipped"] = report.points_skipped;
    put_skipped(json, report.skipped);
    json["bytes"] = report.bytes;
    json["scratch_bytes"] = report.scratch_bytes;
    json["position_error"] = report.outcome.error;
    json["nodes"] = report.nodes;
    json["levels"] = report.levels;
    json["notes"] = report.notes;
}

void print_build(const std::filesystem::path& output, const BuildReport& report)
{
    for (const std::string& note : report.notes) std::printf("note: %s\n", note.c_str());
    std::printf("%s: %s points in %.1f s (%.2f M points/s), %llu nodes on %u levels, %s (%.2f bytes per point)\n",
                output.string().c_str(), grouped(report.outcome.points_out).c_str(), report.outcome.seconds,
                points_per_second(report.outcome) / 1e6, static_cast<unsigned long long>(report.nodes), report.levels,
                bytes_text(report.bytes).c_str(),
                report.outcome.points_out
                    ? static_cast<double>(report.bytes) / static_cast<double>(report.outcome.points_out)
                    : 0.0);
    std::printf("largest position error %s source units, peak memory %s, scratch at most %s\n",
                exact(report.outcome.error).c_str(), bytes_text(peak_memory_bytes()).c_str(),
                bytes_text(report.scratch_bytes).c_str());
}

// The second step: what discs need beside the positions.
NeighbourAttributeReport compute_normals(const Arguments& arguments, const std::filesystem::path& tree,
                                         const WantedValues& wanted)
{
    NeighbourAttributeOptions options;
    options.wanted = wanted;
    options.neighbours = arguments.normals;
    options.radius_limit = usual_radius_limit;
    options.memory_bytes = arguments.memory;
    options.threads = arguments.options.threads;
    options.progress = console_progress(arguments.common);
    try {
        NeighbourAttributeReport report = compute_neighbour_attributes(tree, options);
        end_progress(arguments.common);
        return report;
    } catch (...) {
        end_progress(arguments.common);
        throw;
    }
}

int build(Arguments& arguments)
{
    std::filesystem::path output = arguments.output;
    if (output.empty()) {
        // Next to the first input, with the same name.
        output = arguments.inputs[0];
        if (output.filename().empty()) output = output.parent_path();
        output.replace_extension(tree_extension);
    }
    arguments.options.memory_bytes = arguments.memory;
    arguments.options.read = arguments.reading.get(arguments.options.threads);
    arguments.options.sampling = arguments.fast ? Sampling::grid : Sampling::poisson;
    arguments.options.progress = console_progress(arguments.common);
    WantedValues wanted;
    wanted.normal = wanted.radius = wanted.confidence = true;
    wanted.radius_neighbours = usual_radius_neighbours;
    NeighbourAttributeReport computed;
    WorkOnTree then;
    if (arguments.normals)
        then = [&](const std::filesystem::path& tree, BuildReport& built) {
            end_progress(arguments.common);
            computed = compute_normals(arguments, tree, wanted);
            std::vector<std::string>& warnings = computed.outcome.warnings;
            built.outcome.warnings.insert(built.outcome.warnings.end(), warnings.begin(), warnings.end());
            warnings.clear();
        };
    const BuildReport report =
        build_tree_then({arguments.inputs.begin(), arguments.inputs.end()}, output, arguments.options, then);
    end_progress(arguments.common);
    Json json;
    json["tree"] = output.string();
    put_build(json, report);
    if (!arguments.common.json) print_build(output, report);
    if (arguments.normals) {
        put_attribute_report(json["normals"], wanted, computed);
        if (!arguments.common.json) print_attribute_report(output, wanted, computed);
    }
    if (arguments.common.json) print_json(json);
    return finished(report.outcome);
}

}  // namespace

Run add_build(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("input", arguments->inputs, "Files, and folders with their sub-folders, merged into one cloud")
        .required();
    options.option("-o,--output", arguments->output,
                   "Tree folder to write (default: the first input's name with .pct)");
    options.option("-m,--memory", arguments->memory, "Memory limit of the build, e.g. 512M or 2G (default 1G)").bytes();
    options.option("-t,--threads", arguments->options.threads, "Threads (default: one per processor)");
    options.option("--chunk-points", arguments->options.chunk_points,
                   "Maximum number of points per chunk (default 25000)");
    options.flag("--fast", arguments->fast, "Sample the levels on a grid: faster, but less evenly spaced");
    options
        .option(
            "--normals", arguments->normals,
            "Then compute normals and radii of so many nearest neighbours, e.g. 16: what perspective-accurate discs "
            "are drawn with (pcmlab normals has more choices)")
        .between(1, 1024);
    options.flag("--overwrite", arguments->options.overwrite, "Replace an existing tree of this name");
    options.off_flag("--no-resume", arguments->options.resume,
                     "Do not resume an interrupted build of these files, and write no checkpoints");
    options
        .option("--checkpoint-seconds", arguments->options.checkpoint_seconds,
                "Time between checkpoints, from which an interrupted build resumes (default 1)")
        .not_negative();
    arguments->reading.add_to(options);
    arguments->reading.add_ignore_crs(options);
    add_common(options, arguments->common);
    return [arguments] { return build(*arguments); };
}

}  // namespace pcm::cli
