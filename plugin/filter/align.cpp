// Align Point Clouds by Pairs: the motion from picked points, as the layer's matrix or as a new tree.
#include "pcm/align/pair_text.h"
#include "pcm/align/pick_spacing.h"
#include "pcm/align/rigid_fit.h"
#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/result_parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/registry.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/moved_tree.h"
#include "plugin/scene/result_layer.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    parameters.addParam(RichString("Pairs", "", "Pairs",
                                   "Three or more pairs of points, separated by semicolons: x y z in the tree that is "
                                   "moved, x y z of the same place in the other cloud, source coordinates; then, "
                                   "optionally, a weight (default 1). Empty, the default: those of the file."));
    parameters.addParam(RichString("PairsFile", "", "File of pairs",
                                   "A text file of pairs, one a line, as 'pcmlab align --pairs' reads it and the tool "
                                   "Align by Picked Pairs saves it. They count beside the pairs above. Empty, the "
                                   "default: no file."));
    parameters.addParam(RichBool("Scale", false, "Fit a scale",
                                 "Fit a scale beside rotation and translation: for clouds in different units. Default "
                                 "off."));
    parameters.addParam(
        RichString("PickError", "", "Uncertainty of a pick",
                   "Standard deviation of a picked point, source units. Pairs that lie no farther apart "
                   "than a few times that are refused. Empty, the default: a quarter of the distance "
                   "between the tree's points there."));
    parameters.addParam(RichBool("SetMatrix", false, "Set the layer's matrix",
                                 "Only set the matrix of the current layer, which MeshLab keeps in single precision; "
                                 "no output folder is needed. Off: write a new tree, in double. Default off."));
    add_result_parameters(parameters, false);
}

std::vector<PointPair> pairs_of(const RichParameterList& parameters)
{
    // A pair a line, as in files: here lines are separated by semicolons.
    QString typed = parameters.getString("Pairs");
    std::vector<PointPair> pairs = parse_pairs(typed.replace(';', '\n').toStdString(), "Pairs");
    const QString file = parameters.getString("PairsFile").trimmed();
    if (!file.isEmpty())
        for (const PointPair& pair : read_pairs(absolute_path(file))) pairs.push_back(pair);
    return pairs;
}

double pick_error(const FilterRun& run, PointCloud& cloud, const std::vector<PointPair>& pairs)
{
    if (const auto given = numbers_of(run.parameters, "PickError", "Uncertainty of a pick", 1)) return given->front();
    std::vector<double> spacings;
    for (const PointPair& pair : pairs) spacings.push_back(spacing_at(cloud, pair.moving).spacing);
    return pick_error_of(spacings);
}

void log_fit(const FilterRun& run, const RigidFit& fit, const Box3d& box)
{
    for (std::size_t i = 0; i < fit.residuals.size(); ++i)
        run.log("Pair " + std::to_string(i + 1) + ": residual " + brief(fit.residuals[i]) + ".");
    run.log("RMS of the residuals: " + brief(fit.rms) + " source units; rotation " + exact(fit.radians * 180 / pi) +
            " degrees about " + exact(fit.axis) + "; translation of the pairs' centroid " + exact(fit.shift) +
            "; scale " + exact(fit.scale) +
            (fit.scale == 1 ? " (the pairs suggest " + brief(fit.pairs_scale) + ")" : "") + ".");
    run.log("Uncertainty of the moved cloud: " + brief(fit.error_at(fit.motion.pivot)) +
            " at the pairs' centroid, up to " + brief(fit.largest_error(box)) +
            " at its corners (one standard deviation, source units).");
}

void set_matrix(const FilterRun& run, const std::filesystem::path& path, const RigidFit& fit, const Box3d& box)
{
    MeshModel* const layer = run.document.mm();
    const auto shown = layer ? Registry::instance().find(*layer) : std::nullopt;
    std::error_code ignored;
    if (!shown || !std::filesystem::equivalent(shown->cloud->tree()->folder(), path, ignored))
        throw Error(ErrorCode::invalid_argument, path, "the current layer does not show this tree",
                    "choose its layer, or write a new tree");
    scene_of(run.document)
        .part<LayerMatrices>()
        .set(layer_of(*layer), matrix_of(fit.motion, shown->origin),
             QString("align by %1 pairs").arg(fit.residuals.size()));
    run.log("The matrix of the layer '" + layer->label().toStdString() +
            "' moves it; rounded to single precision, it moves points by up to " +
            brief(matrix_rounding(fit.motion, shown->origin, box)) + " source units more or less.");
}

void run(const FilterRun& run)
{
    const std::filesystem::path path = tree_of(run.parameters, run.document);
    const bool only_matrix = run.parameters.getBool("SetMatrix");
    const ResultOptions result = only_matrix ? ResultOptions() : result_options_of(run.parameters);
    const auto cloud = PointCloud::open(path);
    const auto pairs = pairs_of(run.parameters);
    fit_motion(pairs);
    FitOptions options;
    options.scale = run.parameters.getBool("Scale");
    options.pick_error = pick_error(run, *cloud, pairs);
    const RigidFit fit = fit_motion(pairs, options);
    const Box3d box = cloud->info().bounds();
    log_fit(run, fit, box);
    if (only_matrix) return set_matrix(run, path, fit, box);
    BuildOptions build;
    build.memory_bytes = result.memory_bytes;
    build.threads = result.threads;
    build.overwrite = result.overwrite;
    Operation operation(run.callback);
    build.progress = operation.progress();
    const BuildReport report = write_moved_tree(cloud->tree(), {fit.motion}, result.target.copy, build);
    log_result(run, "Aligned " + path.string(), report);
    SceneLayer* const former = layer_showing(scene_of(run.document), path);
    show_moved_result(run, result.target.copy, former ? std::vector<SceneLayer*>{former} : std::vector<SceneLayer*>());
}

}  // namespace

Filter align()
{
    using F = MeshFilterInterface;
    return {"Align Point Clouds by Pairs",
            "Moves a <b>point cloud tree</b> to another cloud by three or more pairs of points: the rotation and "
            "translation (optionally the scale) with the least squares of the residuals, which the log reports with "
            "their uncertainty. The pairs' source coordinates count; a matrix that the layer has is replaced. Writes a "
            "new tree, or sets the matrix of the current layer. The tool <i>Align by Picked Pairs</i> picks the pairs "
            "in the view.",
            F::FilterClass(F::MeshCreation | F::PointSet | F::Layer),
            add_parameters,
            run,
            "-aligned.pct"};
}

}  // namespace pcm::host
