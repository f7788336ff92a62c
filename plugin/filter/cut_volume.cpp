// Cut Volume: between a tree's surface and a height, a plane or another tree.
#include "pcm/measure/volume.h"

#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/measure_parameters.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/result_parameters.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    parameters.addParam(RichString("Polygon", "", "Polygon",
                                   "Corners of the area, seen from above: x y of each, in source coordinates and "
                                   "units, separated by blanks. Empty, the default: the box of the tree."));
    parameters.addParam(RichEnum("Reference", 0, {"Height", "Plane", "Another tree"}, "Compare with",
                                 "Whether the surface is compared with 'Height', the default, with 'Plane', or with "
                                 "the surface of another tree, which was there before."));
    parameters.addParam(RichString("Height", "0", "Height", "Height to compare with, in source units. Default 0."));
    parameters.addParam(RichString("Plane", "", "Plane",
                                   "Plane to compare with: x y z of a point and of the normal, six numbers, in source "
                                   "coordinates. Empty by default."));
    parameters.addParam(
        RichString("TreeBefore", "", "Tree before", "Folder of the tree to compare with. Empty by default."));
    parameters.addParam(RichFloat("Side", 0, "Side of a cell",
                                  "Side of the square cells that the area is divided into, in source units. 0, the "
                                  "default: so that cells that have points have about 9."));
    parameters.addParam(RichEnum("CellHeight", 0, {"Mean", "Lowest", "Highest"}, "Height of a cell",
                                 "Of the heights of the points in a cell the mean, the lowest or the highest. Default "
                                 "'Mean'."));
    parameters.addParam(RichBool("Interpolate", true, "Interpolate empty cells",
                                 "Cells without points get heights from those around them, and the uncertainty "
                                 "contains what that may be wrong by. Default on. Off: they are left out, and the "
                                 "volume is that of the part of the polygon that has points."));
    add_part_parameters(parameters);
    parameters.addParam(RichString("Name", "", "Name", "Name of the measure in the output. Default: Volume 1."));
    add_output_file_parameters(parameters,
                               ".json (a list that can be read again), .csv, .geojson or .dxf, as its name ends");
}

void set_reference(const RichParameterList& parameters, VolumeOptions& options)
{
    switch (parameters.getEnum("Reference")) {
        case 0: {
            const auto height = numbers_of(parameters, "Height", "Height", 1);
            if (!height) throw Error(ErrorCode::invalid_argument, {}, "there is no height to compare with");
            options.reference.height = (*height)[0];
            return;
        }
        case 1: {
            const auto plane = numbers_of(parameters, "Plane", "Plane", 6);
            if (!plane) throw Error(ErrorCode::invalid_argument, {}, "there is no plane to compare with");
            options.reference =
                plane_of({(*plane)[0], (*plane)[1], (*plane)[2]}, {(*plane)[3], (*plane)[4], (*plane)[5]});
            return;
        }
        default:
            break;
    }
    const QString before = parameters.getString("TreeBefore").trimmed();
    if (before.isEmpty()) throw Error(ErrorCode::invalid_argument, {}, "there is no tree to compare with");
    options.before = PointCloud::open(absolute_path(before));
}

Measure measure_of(const FilterRun& run, const VolumeOptions& options, const VolumeReport& report,
                   const PointCloud& cloud)
{
    Measure measure;
    measure.kind = MeasureKind::volume;
    measure.name = run.parameters.getString("Name").toStdString();
    measure.computed = report.values();
    std::vector<Vec3d> polygon = options.polygon;
    if (polygon.empty()) polygon = plan_rectangle(cloud.info().bounds());
    for (const Vec3d& p : polygon) measure.points.push_back({p, 0, 0, cloud.tree()->folder().string()});
    return measure;
}

void run(const FilterRun& run)
{
    MeasureFileOptions file_options;
    file_options.overwrite = overwrite_of(run.parameters);
    const std::filesystem::path output = output_file_of(run.parameters);
    if (!output.empty()) check_output(output, file_options.overwrite);
    const auto cloud = PointCloud::open(tree_of(run.parameters, run.document));
    file_options.system = coordinate_system_of(cloud->info().metadata);
    VolumeOptions options;
    options.polygon = points_parameter(run.parameters, "Polygon", "Polygon", 2,
                                       cloud->info().points ? cloud->info().bounds().min[2] : 0);
    set_reference(run.parameters, options);
    options.side = decimal_of(run.parameters, "Side");
    options.height = static_cast<CellHeight>(run.parameters.getEnum("CellHeight"));
    if (!run.parameters.getBool("Interpolate")) options.empty = EmptyCells::left_out;
    options.level = level_of(run.parameters, *cloud);
    options.where = where_of(run.parameters);
    Operation operation(run.callback);
    options.progress = operation.progress();
    const VolumeReport report = measure_volume(*cloud, options);
    MeasureList list;
    list.add(measure_of(run, options, report, *cloud));
    log_measure(run, list[0], length_unit_of(file_options.system));
    run.log(grouped(report.outcome.points_out) + " points in " + grouped(report.cells) + " cells, " +
            grouped(report.cells_without_data) + " of them without points, in " + brief(report.outcome.seconds) + " s");
    for (const std::string& note : report.notes()) run.log("Note: " + note + ".");
    if (const std::string caution = caution_of(file_options.system); !caution.empty())
        run.log("Note: " + caution + ".");
    if (output.empty()) return;
    write_measures(list, output, file_options);
    run.log(output.string() + " written");
}

}  // namespace

Filter cut_volume()
{
    return {"Cut Volume",
            "Computes how much of a <b>point cloud tree</b>'s surface lies above (cut) and below (fill) a height, a "
            "plane or the surface of another tree, in a polygon seen from above, on a grid of square cells. The "
            "uncertainty comes from the spread of the heights in the cells, from cells twice as wide, and from "
            "the interpolation of cells without points. It takes clouds of any size in bounded memory. Esc cancels it.",
            MeshFilterInterface::Measure, add_parameters, run};
}

}  // namespace pcm::host
