// Select Points of Point Cloud Tree: by region, conditions and connectivity.
#include "pcm/select/select_points.h"

#include "pcm/cloud/region.h"
#include "pcm/select/grow.h"
#include "pcm/system/error.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/result_parameters.h"
#include "plugin/filter/selected_points.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/selection_text.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

// In the order of the parameter's choices.
enum class Step { replace, add, subtract, intersect, invert, none };

void add_parameters(RichParameterList& parameters)
{
    parameters.addParam(RichEnum(
        "Operation", 0, {"Replace", "Add", "Subtract", "Intersect", "Invert selection", "Select nothing"}, "Operation",
        "What becomes of the points that are selected already. Replace: they are replaced by the points found. Add, "
        "Subtract, Intersect: the points found are added, taken away, or those that are in both stay. Invert selection "
        "and Select nothing use no other parameter. Default Replace."));
    parameters.addParam(RichString(
        "Region", "", "Region",
        "Only points in this region, in source coordinates and units: box X0 Y0 Z0 X1 Y1 Z1; sphere X Y Z RADIUS; "
        "polygon X0 Y0 X1 Y1 X2 Y2 ... (in plan, at any height); oriented-box, ray, cone, frustum, planes, prism or "
        "lasso with the numbers that 'pcmlab select --help' lists. Empty, the default: no region."));
    parameters.addParam(
        RichString("Where", "", "Where",
                   "Only points that meet these conditions on attributes, separated by semicolons. Example: "
                   "classification = 7,18; intensity < 10. Empty, the default: no condition."));
    parameters.addParam(RichBool("InClip", true, "Only what the clip box shows",
                                 "Where the project has a clip box that is switched on, only points that it shows. "
                                 "Default on."));
    parameters.addParam(RichString(
        "GrowFrom", "", "Grow from",
        "x y z in source coordinates: all points that steps from point to point reach from the point nearest to it, "
        "through points that the region, the conditions and the clip box choose. Empty, the default: do not grow."));
    parameters.addParam(RichString("GrowDistance", "", "Longest step",
                                   "Of growing, from point to point, source units. Needed with 'Grow from'; no "
                                   "default."));
    add_work_parameters(parameters);
}

PointSet grown(const FilterRun& run, const TreeLayer& shown, const std::vector<double>& from, const Selection& limit,
               const ProgressFunction& progress)
{
    const auto distance = numbers_of(run.parameters, "GrowDistance", "Longest step", 1);
    if (!distance)
        throw Error(ErrorCode::invalid_argument, {}, "Longest step is empty",
                    "give the length of a step, source units");
    const auto nearest = shown.cloud->nearest({from[0], from[1], from[2]}, 1).points;
    if (nearest.empty()) throw Error(ErrorCode::invalid_argument, {}, "the tree has no point to grow from");
    PointSet seeds(shown.cloud->tree());
    seeds.set(nearest[0].node, {nearest[0].index});
    GrowOptions options;
    options.limit = limit;
    options.memory_bytes = memory_of(run.parameters);
    options.threads = threads_of(run.parameters);
    options.progress = progress;
    run.log("Grown from the point at " + exact(nearest[0].position) + ", " + brief(nearest[0].distance()) +
            " source units from the one given.");
    return grow(seeds, distance->front(), options);
}

PointSet find(const FilterRun& run, const MeshModel& layer, const TreeLayer& shown, const ProgressFunction& progress)
{
    Selection selection = parse_selection("", run.parameters.getString("Where"));
    const QString region = run.parameters.getString("Region").trimmed();
    if (!region.isEmpty()) selection.region = parse_region(region.toStdString());
    refuse_impossible_box(selection);
    const auto from = numbers_of(run.parameters, "GrowFrom", "Grow from", 3);
    if (!from && !selection.chooses_points())
        throw Error(ErrorCode::invalid_argument, {},
                    "neither a region nor a condition nor a place to grow from is given", "give one of them");
    if (run.parameters.getBool("InClip"))
        if (const auto clip = clip_of(layer_of(layer))) selection.clips.push_back(*clip);
    if (from) return grown(run, shown, *from, selection, progress);
    SelectOptions options;
    options.threads = threads_of(run.parameters);
    options.progress = progress;
    return select_points(shown.cloud->tree(), selection, options);
}

// Of the operations that combine.
SetOperation set_operation(Step step)
{
    return step == Step::add         ? SetOperation::add
           : step == Step::subtract  ? SetOperation::subtract
           : step == Step::intersect ? SetOperation::intersect
                                     : SetOperation::replace;
}

void run(const FilterRun& run)
{
    const auto step = static_cast<Step>(in_range(run.parameters, "Operation", "Operation", 0, 5));
    const auto [layer, shown] = layer_with_tree(run.document);
    SceneState& scene = scene_of(run.document).part<SceneState>();
    const auto before = scene.selection(layer_of(*layer));
    PointSet set = before ? *before : PointSet(shown.cloud->tree());
    QString words;
    if (step == Step::none) {
        set = PointSet(shown.cloud->tree());
        words = "nothing";
    } else if (step == Step::invert) {
        set.invert();
        words = "inverted";
    } else {
        Operation operation(run.callback);
        const PointSet found = find(run, *layer, shown, operation.progress());
        run.log(grouped(found.size()) + " points found" +
                (found.empty() ? "; " + extent_text(shown.cloud->info().bounds()) + "." : "."));
        set.combine(set_operation(step), found);
        words = "filter";
    }
    run.log(grouped(set.size()) + " of the " + grouped(shown.cloud->info().points) + " points of " +
            shown.cloud->tree()->folder().string() + " are selected.");
    words += QString(", %1 points").arg(QString::fromStdString(grouped(set.size())));
    scene.select(layer_of(*layer), std::make_shared<const PointSet>(std::move(set)), words);
}

}  // namespace

Filter select_points_filter()
{
    using F = MeshFilterInterface;
    return {
        "Select Points of Point Cloud Tree",
        "Selects points of the <b>point cloud tree</b> that the current layer shows, at full resolution: those in a "
        "region, that meet conditions, or that are connected with a place. The selection is shown in colour; the "
        "filters <i>Selected Points</i> save, extract, classify and delete it. It can be taken back with the tool "
        "<i>Select Points</i>. A selection lasts until the tree changes or the project is closed; in a script of "
        "meshlabserver, for the one run. Esc cancels it.",
        F::FilterClass(F::Selection | F::PointSet), add_parameters, run};
}

}  // namespace pcm::host
