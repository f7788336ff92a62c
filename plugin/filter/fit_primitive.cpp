// Fit Primitive: a shape at given places of a cloud, followed through it.
#include "pcm/place/fit_at.h"

#include "pcm/filter/set_points.h"
#include "pcm/fit/pcl_fit.h"
#include "pcm/io/writer.h"
#include "pcm/system/error.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/measure_parameters.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/primitive_parameters.h"
#include "plugin/filter/result_parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/open_tool.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/primitive_book.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/text.h"

#include <QStringList>

namespace pcm::host {

namespace {

constexpr double degree = pi / 180;

void add_shape_parameters(RichParameterList& parameters)
{
    QStringList shapes{"Any"}, methods;
    for (const ShapeTraits& traits : shape_kinds()) shapes << traits.label;
    for (const EstimatorTraits& traits : estimators()) methods << traits.label;
    parameters.addParam(
        RichString("Places", "", "Places",
                   "Places on the surface, x y z of each, in source coordinates and units, separated by "
                   "blanks. One is enough; more of them refine the fit. No default."));
    parameters.addParam(
        RichString("NotPlaces", "", "Other places",
                   "Places that do not belong to it, x y z of each, in source coordinates: points around "
                   "them take no part. Empty, the default: none."));
    parameters.addParam(RichEnum("Shape", 0, shapes, "Shape",
                                 "What is fitted. Any: all kinds are fitted, and the one that explains the points "
                                 "best, with the fewest parameters, is kept. Default Any."));
    parameters.addParam(RichEnum("Estimator", static_cast<int>(Estimator::msac), methods, "Estimator",
                                 "How random samples of points are drawn and scored, where some of the points belong "
                                 "to something else. MSAC suits nearly all scans. Default MSAC."));
    parameters.addParam(
        RichFloat("Threshold", 0, "Threshold",
                  "Largest distance of a point from the surface, source units. 0, the default: from the "
                  "noise of the points around the place."));
    parameters.addParam(RichFloat("Radius", 0, "Radius of the neighbourhood",
                                  "All points so near to a place are fitted, source units. 0, the default: by their "
                                  "number."));
    parameters.addParam(
        RichInt("Count", 0, "Points of the neighbourhood",
                "So many nearest points of a place are fitted, where no radius is given. 0, the default: "
                "as many as the fit needs."));
    parameters.addParam(RichBool("Grow", true, "Follow through the cloud",
                                 "All connected points of the cloud on the surface belong to it, and it is fitted to "
                                 "them again. Off: only the neighbourhood's. Default on."));
    parameters.addParam(RichFloat("Step", 0, "Longest step",
                                  "Points farther apart are not connected, source units. 0, the default: from the "
                                  "points' spacing."));
    parameters.addParam(
        RichEnum("Outline", 2, {"Rectangle", "Convex", "Concave", "Cloud's box"}, "Outline",
                 "How a plane is bounded, and what its area is of: the rectangle of least area around its "
                 "points, their convex hull, a concave outline that follows their edge and gaps, or "
                 "the cloud's box. Default Concave."));
}

void add_search_parameters(RichParameterList& parameters)
{
    parameters.addParam(RichFloat("NormalAngle", 0, "Normals within",
                                  "Largest angle between the shape and the surface of the points around a point, "
                                  "degrees: the shape is not followed where it is larger. 0, the default: 30, computed "
                                  "from the points, and with a threshold not compared. 90: not compared. Where it is "
                                  "given and the cloud has normals, "
                                  "these are compared, too."));
    parameters.addParam(RichFloat("LeastRadius", 0, "Radius from",
                                  "Smaller radii are not considered, source units. 0, the default: any."));
    parameters.addParam(RichFloat("LargestRadius", 0, "Radius to",
                                  "Larger radii are not considered, source units. 0, the default: any."));
    parameters.addParam(
        RichInt("Iterations", 10000, "Samples", "The most samples of points that the search tries. Default 10000."));
    parameters.addParam(RichFloat("Probability", 0.99f, "Probability",
                                  "The search ends when, with this probability, one of the samples was of good points "
                                  "alone. Above 0 and below 1. Default 0.99."));
    parameters.addParam(RichFloat("Seconds", 0, "Time limit",
                                  "Ends the search with the best shape so far, seconds. 0, the default: no limit."));
    parameters.addParam(
        RichInt("Seed", 1, "Seed", "Start of the random numbers: the same seed gives the same result. Default 1."));
    parameters.addParam(RichEnum("Backend", 0, has_pcl() ? QStringList{"Own", "PCL"} : QStringList{"Own"},
                                 "Computed by",
                                 "This program's own search, or the Point Cloud Library's, where its module is "
                                 "installed. Default Own."));
}

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    add_shape_parameters(parameters);
    add_search_parameters(parameters);
    add_limit_parameters(parameters);
    parameters.addParam(RichString("Name", "", "Name",
                                   "Name of the primitive in the list. Empty, the default: its kind and a number."));
    add_drawing_parameters(parameters, false);
    parameters.addParam(RichString("PointsOutput", "", "Points to",
                                   "Tree folder (NAME.pct), which is shown in a layer, or file for the points that "
                                   "belong to it; the extension chooses the format. Empty, the default: the points are "
                                   "only selected, where the current layer shows the tree."));
    add_work_parameters(parameters);
}

FitAtOptions options_of(const FilterRun& run, const PrimitiveCloud& cloud)
{
    const RichParameterList& p = run.parameters;
    constexpr OutlineKind outlines[] = {OutlineKind::rectangle, OutlineKind::convex, OutlineKind::concave,
                                        OutlineKind::box};
    FitAtOptions options;
    const int shape = in_range(p, "Shape", "Shape", 0, static_cast<int>(shape_kinds().size()));
    if (shape == 0)
        for (const ShapeTraits& traits : shape_kinds()) options.kinds.push_back(traits.kind);
    else
        options.fit.kind = static_cast<ShapeKind>(shape - 1);
    options.fit.estimator =
        static_cast<Estimator>(in_range(p, "Estimator", "Estimator", 0, static_cast<int>(estimators().size()) - 1));
    options.fit.threshold = number_of(p, "Threshold", "Threshold");
    options.radius = number_of(p, "Radius", "Radius of the neighbourhood");
    if (options.radius == 0)
        options.count = static_cast<std::size_t>(in_range(p, "Count", "Points of the neighbourhood", 0, 1000000));
    options.grow = p.getBool("Grow");
    options.step = number_of(p, "Step", "Longest step");
    options.outline.kind = outlines[in_range(p, "Outline", "Outline", 0, 3)];
    if (const double angle = number_of(p, "NormalAngle", "Normals within"); angle > 0)
        options.fit.normal_angle = options.turned_angle = angle * degree;
    options.fit.least_radius = number_of(p, "LeastRadius", "Radius from");
    if (const double radius = number_of(p, "LargestRadius", "Radius to"); radius > 0)
        options.fit.largest_radius = radius;
    options.fit.iterations =
        static_cast<std::uint32_t>(in_range(p, "Iterations", "Samples", 1, std::numeric_limits<int>::max()));
    options.fit.probability = number_of(p, "Probability", "Probability");
    options.fit.seconds = number_of(p, "Seconds", "Time limit");
    options.fit.seed = static_cast<std::uint64_t>(in_range(p, "Seed", "Seed", 0, std::numeric_limits<int>::max()));
    options.fit.backend = in_range(p, "Backend", "Computed by", 0, 1) == 1 ? FitBackend::pcl : FitBackend::own;
    options.limit = limit_of(run, cloud);
    options.memory_bytes = memory_of(p);
    options.threads = threads_of(p);
    return options;
}

// Where the points go, or nowhere.
void write_points(const FilterRun& run, const PointSet& points, const MeshModel* layer)
{
    const QString text = run.parameters.getString("PointsOutput").trimmed();
    if (text.isEmpty()) return;
    std::filesystem::path output = absolute_path(text);
    if (output.extension().empty()) output = as_tree(output);
    ExtractOptions options;
    options.overwrite = overwrite_of(run.parameters);
    options.memory_bytes = memory_of(run.parameters);
    options.threads = threads_of(run.parameters);
    ConvertReport report;
    {
        Operation operation(run.callback);
        options.progress = operation.progress();
        report = extract_points(points, output, options);
    }
    log_warnings(run, report.outcome.warnings);
    log_notes(run, report.notes);
    run.log(grouped(report.outcome.points_out) + " points written to " + output.string());
    if (is_tree(output)) show_afterwards(run, [&] { add_tree_layer(run, output, layer); });
}

void run(const FilterRun& run)
{
    check_drawing(run);
    const auto places = points_parameter(run.parameters, "Places", "Places", 3);
    if (places.empty())
        throw Error(ErrorCode::invalid_argument, {}, "no place on the surface is given", "write x y z of one");
    const auto others = points_parameter(run.parameters, "NotPlaces", "Other places", 3);
    const PrimitiveCloud cloud = primitive_cloud_of(run);
    FitAtOptions options = options_of(run, cloud);
    std::optional<FittedPrimitive> found;
    {
        Operation operation(run.callback);
        options.progress = operation.progress();
        found = fit_at(*cloud.cloud, places, others, options);
    }
    log_notes(run, found->notes);
    Primitive& primitive = found->primitive;
    if (!primitive.fit.has_shape())
        throw Error(ErrorCode::invalid_argument, cloud.cloud->tree()->folder(),
                    std::string("no ") + traits_of(primitive.fit.shape.kind).name + " was fitted (" +
                        name_of(primitive.fit.issue) + ")",
                    primitive.fit.message);
    primitive.name = run.parameters.getString("Name").trimmed().toStdString();
    primitive.cloud = cloud.layer ? cloud_name(layer_of(*cloud.layer)) : cloud.cloud->tree()->folder().string();
    PrimitiveBook& book = scene_of(run.document).part<PrimitiveBook>();
    std::size_t index = 0;
    primitive.colour = next_colour(book.list());
    book.change([&](PrimitiveList& list) { index = list.add(primitive); });
    const auto points = std::make_shared<const PointSet>(std::move(found->points));
    book.keep_points(book.list()[index], points, found->reached);
    open_tool(run.document, "Fit Primitives");  // its panel has the list
    const Primitive kept = book.list()[index];
    if (kept.fit.verdict == FitVerdict::doubtful) run.warn(kept.name + " is doubtful: " + kept.fit.message);
    log_primitive(run, kept, cloud.unit);
    if (cloud.layer)
        scene_of(run.document)
            .part<SceneState>()
            .select(layer_of(*cloud.layer), points,
                    QString("%1, %2 points")
                        .arg(QString::fromStdString(kept.name), QString::fromStdString(grouped(points->size()))));
    write_drawing(run, {kept}, cloud.unit);
    note_matrix(run, cloud);
    write_points(run, *points, cloud.layer);
}

}  // namespace

Filter fit_primitive()
{
    using F = MeshFilterInterface;
    return {
        "Fit Primitive",
        "Fits a plane, cylinder, sphere, cone or torus to the points around given places of a <b>point cloud tree</b> "
        "and follows it through the whole cloud, with standard deviations. The primitive is added to the project's "
        "list, which the tool <i>Fit Primitives</i> shows; its points are selected, and written as a tree or file on "
        "request. Fits that the points do not determine are refused or said to be doubtful. Esc cancels it.",
        F::FilterClass(F::Measure | F::PointSet), add_parameters, run};
}

}  // namespace pcm::host
