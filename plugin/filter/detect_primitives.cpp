// Detect Primitives: all planes, cylinders and spheres of a cloud.
#include "pcm/detect/detect.h"

#include "pcm/shapes/primitive_text.h"
#include "pcm/system/error.h"
#include "pcm/system/output_group.h"
#include "pcm/system/rounded_text.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/primitive_parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/open_tool.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/drawn_primitives.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/primitive_book.h"
#include "plugin/scene/selection_text.h"
#include "plugin/scene/text.h"

#include <array>
#include <limits>

namespace pcm::host {

namespace {

constexpr double degree = pi / 180;
constexpr std::array<std::array<std::uint8_t, 3>, 3> colours{{{90, 190, 255}, {255, 200, 0}, {120, 220, 90}}};

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    parameters.addParam(RichBool("Planes", true, "Planes", "Detect planes. Default on."));
    parameters.addParam(RichBool("Cylinders", true, "Cylinders", "Detect cylinders. Default on."));
    parameters.addParam(RichBool("Spheres", true, "Spheres", "Detect spheres. Default on."));
    parameters.addParam(
        RichInt("LeastPoints", 500, "Least points", "Shapes with fewer points are left out. Default 500."));
    parameters.addParam(
        RichFloat("Threshold", 0, "Threshold",
                  "Largest distance of a point from its surface, source units. 0, the default: from the "
                  "noise of the cloud."));
    parameters.addParam(RichFloat("NormalAngle", 20, "Normals within",
                                  "Largest angle between the normals of a point and of its surface, degrees. Default "
                                  "20."));
    parameters.addParam(RichFloat("Step", 0, "Longest step",
                                  "Points farther apart are not of one primitive, source units. 0, the default: as the "
                                  "spacing around each allows."));
    parameters.addParam(
        RichInt("Seed", 1, "Seed",
                "Start of the random numbers of the search: the same seed gives the same result. Default 1."));
    parameters.addParam(RichString("Box", "", "Box",
                                   "Only points in this box: the smallest x y z and the largest x y z, source "
                                   "coordinates. Empty, the default: all points."));
    add_limit_parameters(parameters);
    add_drawing_parameters(parameters, false);
    parameters.addParam(RichBool("Labels", false, "Label the points",
                                 "Write which primitive each point belongs to as an attribute: its number in the list, "
                                 "or 0. Into a copy of the tree, or in place. Default off."));
    parameters.addParam(
        RichString("Attribute", "primitive", "Attribute",
                   "Name of the attribute that gets the labels. One of this name that was not made so is "
                   "refused, unless 'Overwrite' is on. Default primitive."));
    add_target_parameters(parameters);
    add_work_parameters(parameters);
}

DetectOptions options_of(const FilterRun& run, const PrimitiveCloud& cloud)
{
    const RichParameterList& p = run.parameters;
    DetectOptions options;
    options.kinds.clear();
    if (p.getBool("Planes")) options.kinds.push_back(ShapeKind::plane);
    if (p.getBool("Cylinders")) options.kinds.push_back(ShapeKind::cylinder);
    if (p.getBool("Spheres")) options.kinds.push_back(ShapeKind::sphere);
    if (options.kinds.empty())
        throw Error(ErrorCode::invalid_argument, {}, "no kind of primitive is chosen", "switch one on");
    constexpr int most = std::numeric_limits<int>::max();
    options.least_points = static_cast<std::uint64_t>(in_range(p, "LeastPoints", "Least points", 1, most));
    options.threshold = number_of(p, "Threshold", "Threshold");
    options.normal_angle = number_of(p, "NormalAngle", "Normals within") * degree;
    options.step = number_of(p, "Step", "Longest step");
    options.seed = static_cast<std::uint64_t>(in_range(p, "Seed", "Seed", 0, most));
    options.limit = limit_of(run, cloud);
    options.limit.box = parse_selection(p.getString("Box"), {}).box;
    options.memory_bytes = memory_of(p);
    options.threads = threads_of(p);
    return options;
}

// ", radius 0.2000"
std::string radius_text(const ShapeFit& fit)
{
    if (!traits_of(fit.shape.kind).radius) return {};
    return ", radius " + rounded_text(fit.shape.radius, fit.errors.radius);
}

void label(const FilterRun& run, const PrimitiveCloud& cloud, const DetectReport& found, LabelOptions options)
{
    LabelReport report;
    {
        Operation operation(run.callback);
        options.progress = operation.progress();
        report = label_primitives(cloud.cloud->tree(), found, options);
    }
    log_warnings(run, report.outcome.warnings);
    run.log(report.tree.string() + ": the attribute '" + options.attribute +
            "' says which primitive each point is of.");
    show_result(run, cloud.cloud->tree()->folder(), options.target);
}

void run(const FilterRun& run)
{
    check_drawing(run);
    const PrimitiveCloud cloud = primitive_cloud_of(run);
    DetectOptions options = options_of(run, cloud);
    LabelOptions labels;
    const bool labelled = run.parameters.getBool("Labels");
    if (labelled) {
        labels.target = target_of(run.parameters);
        labels.attribute = run.parameters.getString("Attribute").trimmed().toStdString();
        labels.overwrite = run.parameters.getBool("Overwrite");
        labels.memory_bytes = options.memory_bytes;
        labels.threads = options.threads;
        if (labels.target.in_place) refuse_locked(scene_of(run.document), cloud.cloud->tree()->folder());
    }
    if (labelled) check_label_attribute(*cloud.cloud->tree(), labels);
    DetectReport found;
    {
        Operation operation(run.callback);
        options.progress = operation.progress();
        found = detect_primitives(cloud.cloud->tree(), options);
    }
    log_notes(run, found.notes);
    log_warnings(run, found.outcome.warnings);
    const std::string name = cloud.layer ? cloud_name(layer_of(*cloud.layer)) : cloud.cloud->tree()->folder().string();
    for (Primitive& primitive : found.primitives) {
        primitive.cloud = name;
        primitive.colour = colours[static_cast<std::size_t>(primitive.fit.shape.kind) % colours.size()];
        run.log(primitive.name + ": " + place_text(primitive.fit) + radius_text(primitive.fit) + ", residual " +
                brief(primitive.fit.rms) + ", " + grouped(primitive.points) + " points");
    }
    run.log(grouped(found.primitives.size()) + " primitives; " + grouped(found.outcome.points_out) + " of " +
            grouped(found.outcome.points_in) + " points belong to one; threshold " + brief(found.threshold) + ", " +
            brief(found.outcome.seconds) + " s.");
    if (found.primitives.empty()) return run.log("Nothing was found: the list and the tree stay as they are.");
    scene_of(run.document).part<PrimitiveBook>().change([&](PrimitiveList& list) { list.add_all(found.primitives); });
    open_tool(run.document, "Fit Primitives");  // its panel has the list
    OutputGroup drawing;                        // it is there only when the labels are
    write_drawing(run, found.primitives, cloud.unit);
    note_matrix(run, cloud);
    if (labelled) label(run, cloud, found, labels);
    try {
        drawing.put_in_place();
    } catch (const Error& error) {
        if (!labelled) throw;
        run.warn(std::string("the labels are written, but not the list: ") + error.what());
    }
}

}  // namespace

Filter detect_primitives_filter()
{
    using F = MeshFilterInterface;
    return {
        "Detect Primitives",
        "Finds all planes, cylinders and spheres of a <b>point cloud tree</b> that have at least so many points, in "
        "bounded memory, and fits them with standard deviations. They are added to the project's list, which the "
        "tool <i>Fit Primitives</i> shows, and are written as a drawing or list on request; labels say which points "
        "belong to them. Esc cancels it.",
        F::FilterClass(F::Measure | F::PointSet),
        add_parameters,
        run,
        "-labelled.pct"};
}

}  // namespace pcm::host
