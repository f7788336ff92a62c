#include "plugin/filter/tree_updates.h"

#include "pcm/system/error.h"
#include "pcm/convert/open_cloud.h"
#include "plugin/filter/parameters.h"
#include "plugin/host/layer.h"
#include "plugin/host/operation.h"
#include "plugin/host/registry.h"
#include "plugin/host/selection_text.h"
#include "plugin/host/text.h"
#include "pcm/update/append.h"
#include "pcm/update/clone.h"
#include "pcm/update/compact.h"
#include "pcm/update/erase.h"

namespace pcm::host {

namespace {

namespace fs = std::filesystem;

using Lines = std::vector<std::string>;

// Layers that showed the tree as it was show it as it is.
void show_anew(MeshDocument& document, const fs::path& folder, Lines& lines)
{
    std::error_code ignored;
    for (MeshModel* layer : document.meshList) {
        const auto shown = Registry::instance().find(*layer);
        if (!shown || !fs::equivalent(shown->cloud->tree()->folder(), folder, ignored)) continue;
        const auto cloud = Registry::instance().open(folder);
        if (cloud->info().points == 0) {
            clear_layer(*layer);
            lines.push_back("The layer " + layer->label().toStdString() +
                            " is empty: its tree has no points any more.");
            continue;
        }
        show_tree(*layer, cloud);
        lines.push_back("The layer " + layer->label().toStdString() + " shows it.");
    }
}

// Where the result goes: the tree itself, or a copy of it made on the spot.
class Target {
public:
    Target(const fs::path& tree, const RichParameterList& parameters) : path_(tree)
    {
        if (parameters.getBool("InPlace")) return;
        const QString given = parameters.getString("Output");
        if (given.trimmed().isEmpty())
            throw Error(ErrorCode::invalid_argument, {}, "neither an output folder is given nor is 'In place' on",
                        "name the tree to write, or let the tree itself be changed");
        path_ = as_tree(absolute_path(given));
        clone_tree(tree, path_);
        cloned_ = true;
    }
    ~Target()
    {
        std::error_code ignored;
        if (cloned_ && !kept_) fs::remove_all(path_, ignored);
    }
    Target(const Target&) = delete;
    Target& operator=(const Target&) = delete;

    const fs::path& path() const { return path_; }
    // What was done is done: shows the result.
    void keep(MeshDocument& document, Lines& lines)
    {
        kept_ = true;
        if (!cloned_) return show_anew(document, path_, lines);
        const auto cloud = Registry::instance().open(path_);
        if (cloud->info().points == 0) {
            lines.push_back("It has no points, so no layer shows it.");
            return;
        }
        MeshModel* layer = document.addNewMesh(QString::fromStdString(path_.string()),
                                               QString::fromStdString(path_.filename().string()));
        try {
            for (std::string& line : show_tree(*layer, cloud)) lines.push_back(std::move(line));
        } catch (...) {
            document.delMesh(layer);
            throw;
        }
    }

private:
    fs::path path_;
    bool cloned_ = false, kept_ = false;
};

void add_target_parameters(RichParameterList& parameters)
{
    parameters.addParam(
        RichString("Output", "", "Output folder",
                   "The tree folder to write, NAME.pct; it shares what did not change with the old one, so it "
                   "takes little time and space. Not used when 'In place' is on. No default."));
    parameters.addParam(
        RichBool("InPlace", false, "In place",
                 "Change the tree itself. It is the old one until all is done, then the new one. Default off."));
}

}  // namespace

void add_append_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    add_inputs_parameter(
        parameters,
        "all their points are added. They must lie on the tree's grid and have no attribute that it has not.");
    add_target_parameters(parameters);
    add_work_parameters(parameters);
}

Lines append_to_tree(MeshDocument& document, const RichParameterList& parameters, vcg::CallBackPos* callback)
{
    const fs::path tree = tree_of(parameters, document);
    AppendOptions options;
    options.memory_bytes = memory_of(parameters);
    options.threads = threads_of(parameters);
    CloudOptions reading;
    reading.read.threads = options.threads;
    const CloudSources sources(inputs_of(parameters), reading);
    const std::unique_ptr<PointReader> cloud = sources.open();

    Operation operation(callback);
    options.progress = operation.progress();
    Target target(tree, parameters);
    const AppendReport report = append_points(target.path(), *cloud, sources.names(), options);
    Lines lines{"Added " + grouped(report.points_added) + " points to " + target.path().string() + " in " +
                brief(report.outcome.seconds) + " s; it has " + grouped(report.outcome.points_out) + " now, in " +
                std::to_string(report.parts) + (report.parts == 1 ? " part." : " parts.")};
    lines.push_back("Largest position error: " + exact(report.outcome.error) + " source units.");
    if (report.points_skipped)
        lines.push_back(grouped(report.points_skipped) + " points without a finite position were left out.");
    for (const std::string& note : report.notes) lines.push_back("Note: " + note);
    target.keep(document, lines);
    return lines;
}

void add_delete_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    parameters.addParam(
        RichString("Box", "", "Box",
                   "Delete only points inside: the smallest x y z and the largest x y z, six numbers between "
                   "blanks, in source coordinates and units, both ends included. Empty, the default: anywhere."));
    parameters.addParam(
        RichString("Where", "", "Where",
                   "Delete only points that meet these conditions on attributes, separated by semicolons. "
                   "Example: classification = 7,18; intensity < 10. Empty, the default: any."));
    parameters.addParam(RichBool("CountOnly", false, "Count only",
                                 "Change nothing, only say how many points would be deleted. Default off."));
    add_target_parameters(parameters);
}

Lines delete_from_tree(MeshDocument& document, const RichParameterList& parameters, vcg::CallBackPos* callback)
{
    const fs::path tree = tree_of(parameters, document);
    const Selection selection = parse_selection(parameters.getString("Box"), parameters.getString("Where"));
    if (!selection.chooses_points())
        throw Error(ErrorCode::invalid_argument, {}, "nothing says which points are to be deleted",
                    "give a box, conditions or both");
    EraseOptions options;
    options.count_only = parameters.getBool("CountOnly");
    Operation operation(callback);
    options.progress = operation.progress();
    if (options.count_only) {
        const EraseReport report = erase_points(tree, selection, options);
        return {grouped(report.points_deleted) + " of the " + grouped(report.outcome.points_in) + " points of " +
                tree.string() + " would be deleted."};
    }
    Target target(tree, parameters);
    const EraseReport report = erase_points(target.path(), selection, options);
    Lines lines{"Deleted " + grouped(report.points_deleted) + " of the " + grouped(report.outcome.points_in) +
                " points of " + target.path().string() + " in " + brief(report.outcome.seconds) + " s."};
    if (!report.coverage_kept)
        lines.emplace_back(
            "Coarse levels have gaps where points went; Compact Point Cloud Tree closes them and frees the space.");
    target.keep(document, lines);
    return lines;
}

void add_compact_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    add_work_parameters(parameters);
}

Lines compact_tree_in_place(MeshDocument& document, const RichParameterList& parameters, vcg::CallBackPos* callback)
{
    const fs::path tree = tree_of(parameters, document);
    CompactOptions options;
    options.memory_bytes = memory_of(parameters);
    options.threads = threads_of(parameters);
    Operation operation(callback);
    options.progress = operation.progress();
    const CompactReport report = compact_tree(tree, options);
    Lines lines{"Compacted " + tree.string() + ": " + grouped(report.build.outcome.points_out) + " points, " +
                bytes_text(report.bytes_before) + " before, " + bytes_text(report.build.bytes) + " now, in " +
                brief(report.build.outcome.seconds) + " s."};
    show_anew(document, tree, lines);
    return lines;
}

}  // namespace pcm::host
