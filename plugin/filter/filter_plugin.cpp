#include "plugin/filter/filter_plugin.h"

#include "plugin/filter/parameters.h"
#include "plugin/filter/tree_information.h"
#include "plugin/filter/tree_updates.h"
#include "plugin/host/layer.h"
#include "plugin/host/operation.h"
#include "plugin/host/registry.h"
#include "plugin/host/text.h"
#include "pcm/build/builder.h"

using namespace pcm;
using namespace pcm::host;

namespace {

// The output's name ends in .pct, which is how MeshLab recognises it.
std::filesystem::path output_path(const QString& text, const std::filesystem::path& first_input)
{
    if (!text.trimmed().isEmpty()) return as_tree(absolute_path(text));
    if (std::filesystem::is_directory(first_input)) return as_tree(first_input);
    return std::filesystem::path(first_input).replace_extension(tree_extension);
}

}  // namespace

PointCloudFilters::PointCloudFilters()
{
    typeList << build_tree_filter << append_filter << delete_filter << compact_filter << tree_information_filter;
    for (const FilterIDType filter : types()) {
        auto* action = new QAction(filterName(filter), this);
        // Without a layer MeshLab disables what is in the menu of our other class.
        connect(action, &QAction::changed, action, [action] { action->setEnabled(true); });
        actionList << action;
    }
}

QString PointCloudFilters::filterName(FilterIDType filter) const
{
    switch (filter) {
        case build_tree_filter:
            return "Build Point Cloud Tree";
        case append_filter:
            return "Append to Point Cloud Tree";
        case delete_filter:
            return "Delete Points of Point Cloud Tree";
        case compact_filter:
            return "Compact Point Cloud Tree";
        case tree_information_filter:
            return "Point Cloud Tree Information";
    }
    return {};
}

QString PointCloudFilters::filterInfo(FilterIDType filter) const
{
    switch (filter) {
        case build_tree_filter:
            return "Reads one or more point cloud files, of any size, and writes a <b>point cloud tree</b>: a folder "
                   "of chunks "
                   "at several levels of detail that MeshLab opens in moments and draws without ever loading all of "
                   "it.<br>"
                   "All points are kept, with all their attributes. The build works in bounded memory; Esc cancels it.";
        case append_filter:
            return "Adds the points of one or more files to a <b>point cloud tree</b>, as a tree of its own that "
                   "shares the old "
                   "one's data, or in place. What is there is not rewritten, so it takes as long as the new points do; "
                   "every level "
                   "of detail stays as even as before. Esc cancels it.";
        case delete_filter:
            return "Deletes the points of a <b>point cloud tree</b> that lie in a box, or whose attributes meet "
                   "conditions, in a tree "
                   "of its own that shares the old one's data, or in place. Only chunks that lose points are written "
                   "anew. "
                   "Esc cancels it.";
        case compact_filter:
            return "Writes a <b>point cloud tree</b> anew, as if it were built of its points now: what was appended "
                   "and what was "
                   "there become one, the space of deleted points is given back, and levels are even again. It is the "
                   "old tree "
                   "until the new one is whole. Esc cancels it.";
        case tree_information_filter:
            return "Writes to the log what a point cloud tree holds: points, bounds in source coordinates, attributes, "
                   "levels "
                   "with their spacing, size, and the largest error of a position.";
    }
    return {};
}

MeshFilterInterface::FilterClass PointCloudFilters::getClass(QAction* action)
{
    // MeshLab offers only filters of the class MeshCreation when there is no layer. It also resets the view after them,
    // which giving information should not do; but the menus are made before any filter is applied.
    if (ID(action) != tree_information_filter) return FilterClass(MeshCreation | PointSet);
    return information_given_ ? Measure : FilterClass(MeshCreation | Measure);
}

void PointCloudFilters::initParameterSet(QAction* action, MeshDocument&, RichParameterList& parameters)
{
    switch (ID(action)) {
        case build_tree_filter:
            add_inputs_parameter(parameters, "together they become one cloud.");
            parameters.addParam(
                RichString("Output", "", "Output folder",
                           "The tree folder to write, NAME.pct. Default: beside the first input, named like it."));
            add_work_parameters(parameters);
            parameters.addParam(
                RichInt("ChunkPoints", default_chunk_points, "Points per chunk",
                        "Most points of a chunk, the unit that is read and drawn, from 1000. Default 25000."));
            parameters.addParam(RichBool(
                "Fast", false, "Fast levels",
                "Choose the points of each level by a grid: about twice as quick a build, and less even a picture from "
                "afar. All points are kept either way. Default off: every level is a Poisson-disk sample."));
            parameters.addParam(
                RichBool("Overwrite", false, "Overwrite",
                         "Replace an existing tree of this name. Nothing but a tree is ever replaced. Default off."));
            parameters.addParam(
                RichBool("Open", true, "Open when done", "Add a layer that shows the new tree. Default on."));
            break;
        case append_filter:
            add_append_parameters(parameters);
            break;
        case delete_filter:
            add_delete_parameters(parameters);
            break;
        case compact_filter:
            add_compact_parameters(parameters);
            break;
        case tree_information_filter:
            add_tree_parameter(parameters);
            break;
    }
}

bool PointCloudFilters::applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                                    vcg::CallBackPos* callback)
{
    errorMessage.clear();
    try {
        switch (ID(action)) {
            case build_tree_filter:
                build(document, parameters, callback);
                break;
            case append_filter:
                say(append_to_tree(document, parameters, callback));
                break;
            case delete_filter:
                say(delete_from_tree(document, parameters, callback));
                break;
            case compact_filter:
                say(compact_tree_in_place(document, parameters, callback));
                break;
            case tree_information_filter:
                information_given_ = true;
                information(document, parameters);
                break;
        }
        return true;
    } catch (...) {
        // Whatever escapes from here would leave the document busy for ever. meshlabserver prints the log only.
        const std::string error = current_error();
        errorMessage = QString::fromStdString(error);
        Log(GLLogStream::WARNING, filterName(ID(action)).toStdString() + ": " + error);
        return false;
    }
}

void PointCloudFilters::build(MeshDocument& document, const RichParameterList& parameters, vcg::CallBackPos* callback)
{
    const auto inputs = inputs_of(parameters);
    const std::filesystem::path output = output_path(parameters.getString("Output"), inputs.front());
    BuildOptions options;
    options.memory_bytes = memory_of(parameters);
    options.threads = threads_of(parameters);
    options.chunk_points =
        static_cast<std::uint32_t>(in_range(parameters, "ChunkPoints", "Points per chunk", 1000, 100'000'000));
    options.sampling = parameters.getBool("Fast") ? Sampling::grid : Sampling::poisson;
    options.overwrite = parameters.getBool("Overwrite");

    Operation operation(callback);
    options.progress = operation.progress();
    const BuildReport report = build_tree(inputs, output, options);
    const Outcome& outcome = report.outcome;
    say("Built " + output.string() + ": " + grouped(outcome.points_out) + " points in " + brief(outcome.seconds) +
        " s" +
        (outcome.seconds > 0
             ? " (" + brief(static_cast<double>(outcome.points_out) / outcome.seconds / 1e6) + " M points/s)"
             : std::string()) +
        ", " + grouped(report.nodes) + " chunks on " + std::to_string(report.levels) + " levels, " +
        bytes_text(report.bytes) + ".");
    say("Largest position error: " + exact(outcome.error) + " source units.");
    if (report.points_skipped) say(grouped(report.points_skipped) + " points without a finite position were left out.");
    for (const std::string& note : report.notes) say("Note: " + note);

    if (!parameters.getBool("Open")) return;
    const auto cloud = Registry::instance().open(output);
    MeshModel* layer = document.addNewMesh(QString::fromStdString(output.string()),
                                           QString::fromStdString(output.filename().string()));
    try {
        say(show_tree(*layer, cloud));
    } catch (...) {
        document.delMesh(layer);
        throw;
    }
}

void PointCloudFilters::information(MeshDocument& document, const RichParameterList& parameters)
{
    const QString given = parameters.getString("Tree");
    say(tree_information(given.trimmed().isEmpty() ? *shown_tree(document)->tree()
                                                   : *Tree::open(absolute_path(given))));
}
