// Selected Points: Extract, to a tree or a file.
#include "pcm/filter/set_points.h"

#include "pcm/io/writer.h"
#include "pcm/system/error.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/selected_points.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    parameters.addParam(RichString("Output", "", "Output",
                                   "The tree folder (NAME.pct) or file to write; the extension chooses the format: "
                                   "las, laz, ply, e57, pcd, xyz, ... A name without extension is a tree. A "
                                   "dialog proposes one; scripts have no default."));
    parameters.addParam(RichBool("Overwrite", false, "Overwrite",
                                 "Replace the output if it exists. Default off: an existing output is an error."));
    parameters.addParam(
        RichBool("AddLayer", true, "Add a layer", "Show the result in a new layer, where it is a tree. Default on."));
    add_work_parameters(parameters);
}

void run(const FilterRun& run)
{
    const SelectedLayer selected = selected_layer(run.document);
    const QString text = run.parameters.getString("Output").trimmed();
    if (text.isEmpty())
        throw Error(ErrorCode::invalid_argument, {}, "no output is given", "name the tree or file to write");
    std::filesystem::path output = absolute_path(text);
    if (output.extension().empty()) output = as_tree(output);
    ExtractOptions options;
    options.overwrite = run.parameters.getBool("Overwrite");
    options.memory_bytes = memory_of(run.parameters);
    options.threads = threads_of(run.parameters);
    ConvertReport report;
    {
        Operation operation(run.callback);
        options.progress = operation.progress();
        report = extract_points(*selected.points, output, options);
    }
    log_warnings(run, report.outcome.warnings);
    log_notes(run, report.notes);
    run.log(grouped(report.outcome.points_out) + " points written to " + output.string() + " (" +
            bytes_text(report.bytes) + ") in " + brief(report.outcome.seconds) + " s.");
    if (is_tree(output) && run.parameters.getBool("AddLayer"))
        show_afterwards(run, [&] { add_tree_layer(run, output, &selected.layer); });
}

}  // namespace

Filter extract_selected()
{
    using F = MeshFilterInterface;
    return {
        "Selected Points: Extract",
        "Writes the selected points of a <b>point cloud tree</b>, with all attributes and bit for bit, as a tree of "
        "their own or as a file. The tree stays as it is. Esc cancels it." +
            about_selections(),
        F::FilterClass(F::Selection | F::Layer | F::PointSet),
        add_parameters,
        run,
        "-part.pct"};
}

}  // namespace pcm::host
