// Build Point Cloud Tree: files become a tree on disk.
#include "pcm/build/builder.h"

#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

// The extension .pct is how MeshLab recognises a tree.
std::filesystem::path output_path(const QString& text, const std::filesystem::path& first_input)
{
    if (!text.trimmed().isEmpty()) return as_tree(absolute_path(text));
    if (std::filesystem::is_directory(first_input)) return as_tree(first_input);
    return std::filesystem::path(first_input).replace_extension(tree_extension);
}

void add_parameters(RichParameterList& parameters)
{
    add_inputs_parameter(parameters, "all of them together become one cloud.");
    parameters.addParam(RichString("Output", "", "Output folder",
                                   "The tree folder to write, NAME.pct. Empty, the default: a folder next to the first "
                                   "input, with the same name."));
    add_largest_coordinate_parameter(parameters);
    add_work_parameters(parameters);
    add_chunk_points_parameter(parameters);
    parameters.addParam(RichBool(
        "Fast", false, "Fast levels",
        "Choose the points of each level of detail with a grid. The build is about twice as fast, but the cloud looks "
        "less even from a distance. All points are kept in any case. Default off: each level is a Poisson-disk "
        "sample."));
    add_ignore_crs_parameter(parameters);
    parameters.addParam(RichBool("Overwrite", false, "Overwrite",
                                 "Replace an existing tree of the same name. Only a tree is ever replaced. Default "
                                 "off."));
    parameters.addParam(RichBool("Open", true, "Open when done", "Add a layer that shows the new tree. Default on."));
}

void report_build(const FilterRun& run, const std::filesystem::path& output, const BuildReport& report)
{
    const Outcome& outcome = report.outcome;
    const std::string rate =
        outcome.seconds > 0
            ? " (" + brief(static_cast<double>(outcome.points_out) / outcome.seconds / 1e6) + " M points/s)"
            : std::string();
    run.log("Built " + output.string() + ": " + grouped(outcome.points_out) + " points in " + brief(outcome.seconds) +
            " s" + rate + ", " + grouped(report.nodes) + " chunks on " + std::to_string(report.levels) + " levels, " +
            bytes_text(report.bytes) + ".");
    run.log("Largest position error: " + exact(outcome.error) + " source units.");
    log_skipped(run, report.points_skipped);
    log_notes(run, report.notes);
    log_warnings(run, report.outcome.warnings);
}

void run(const FilterRun& run)
{
    const auto inputs = inputs_of(run.parameters);
    const std::filesystem::path output = output_path(run.parameters.getString("Output"), inputs.front());
    BuildOptions options;
    options.memory_bytes = memory_of(run.parameters);
    options.threads = threads_of(run.parameters);
    options.chunk_points = chunk_points_of(run.parameters);
    options.sampling = run.parameters.getBool("Fast") ? Sampling::grid : Sampling::poisson;
    options.overwrite = run.parameters.getBool("Overwrite");
    options.read = reading_of(run.parameters);
    options.read.ignore_crs = ignore_crs_of(run.parameters);
    options.read.largest_coordinate = largest_coordinate_of(run.parameters);

    Operation operation(run.callback);
    options.progress = operation.progress();
    report_build(run, output, build_tree(inputs, output, options));
    if (run.parameters.getBool("Open")) show_afterwards(run, [&] { add_tree_layer(run, output); });
}

}  // namespace

Filter build_tree()
{
    using F = MeshFilterInterface;
    return {
        "Build Point Cloud Tree",
        "Reads one or more point cloud files of any size and writes a <b>point cloud tree</b>: a folder of chunks at "
        "several levels of detail. MeshLab opens it within seconds and draws it without loading all of it into "
        "memory.<br>All points are kept, with all their attributes. The build uses a bounded amount of memory. Esc "
        "cancels it.",
        F::FilterClass(F::MeshCreation | F::PointSet), add_parameters, run};
}

}  // namespace pcm::host
