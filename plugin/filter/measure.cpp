// Measure: numbers at points that are given, or at the points of a cloud nearest to them.
#include "pcm/measure/measure.h"

#include "pcm/measure/snap.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/measure_parameters.h"
#include "plugin/filter/parameters.h"
#include "plugin/scene/text.h"

#include <array>

namespace pcm::host {

namespace {

// In the order of the choice; volumes and profiles have filters of their own.
constexpr std::array<MeasureKind, 7> kinds{MeasureKind::distance, MeasureKind::height, MeasureKind::angle,
                                           MeasureKind::area,     MeasureKind::plane,  MeasureKind::surface,
                                           MeasureKind::point};

void add_parameters(RichParameterList& parameters)
{
    parameters.addParam(
        RichEnum("Kind", 0,
                 {"Distance along points", "Height between two points", "Angle at the second of three points",
                  "Area of a polygon", "Distance of the first point to the plane through the others",
                  "Distance to a plane, cylinder, sphere, cone or torus", "Coordinates of a point"},
                 "What to measure", "What is measured at the points. Default 'Distance along points'."));
    parameters.addParam(RichString("Points", "", "Points",
                                   "The points, x y z of each, in source coordinates and units, separated by blanks. "
                                   "There is no default: at least one point is needed."));
    parameters.addParam(
        RichBool("Snap", false, "Nearest points of the cloud",
                 "Measure at the cloud's points that are nearest to these places, at full resolution; "
                 "their spacing and grid give the uncertainty. Default off: at the places themselves."));
    add_tree_parameter(parameters);
    parameters.addParam(
        RichString("Surface", "", "Surface",
                   "For the distance to a surface, in source coordinates and units: 'plane X Y Z NX NY NZ', "
                   "'cylinder X Y Z AX AY AZ RADIUS', 'sphere X Y Z RADIUS', 'cone X Y Z AX AY AZ DEGREES' (apex, axis "
                   "inwards, half the opening angle) or 'torus X Y Z AX AY AZ RADIUS TUBE'. Empty by default."));
    parameters.addParam(RichString("Name", "", "Name", "Name of the measure. Default: its kind and a number."));
    parameters.addParam(RichString("ListFile", "", "List",
                                   "A list of measures (.json): they are written to the output file too, before the "
                                   "new one. Empty, the default: none."));
    add_output_file_parameters(parameters,
                               ".json (a list that can be read again), .csv, .geojson or .dxf, as its name ends");
}

Measure measure_of(const FilterRun& run, PointCloud* cloud)
{
    Measure measure;
    measure.kind = kinds[static_cast<std::size_t>(run.parameters.getEnum("Kind"))];
    measure.name = run.parameters.getString("Name").toStdString();
    if (const QString surface = run.parameters.getString("Surface").trimmed(); !surface.isEmpty()) {
        if (measure.kind != MeasureKind::surface)
            throw Error(
                ErrorCode::invalid_argument, {}, "a surface is given, but nothing is measured to it",
                "choose 'Distance to a plane, cylinder, sphere, cone or torus', or empty the parameter Surface");
        measure.surface = parse_shape(surface.toStdString());
    }
    for (const Vec3d& place : points_parameter(run.parameters, "Points", "Points", 3)) {
        MeasuredPoint point;
        point.position = place;
        if (cloud) {
            const SnappedPoint snapped = snap(*cloud, place);
            run.log("Point " + exact(snapped.point.position) + ", " + brief(snapped.distance) + " source units from " +
                    exact(place));
            point = snapped.point;
        }
        measure.points.push_back(point);
    }
    return measure;
}

void run(const FilterRun& run)
{
    MeasureFileOptions options;
    options.overwrite = overwrite_of(run.parameters);
    const std::filesystem::path output = output_file_of(run.parameters);
    if (!output.empty()) check_output(output, options.overwrite);
    MeasureList list;
    if (const QString file = run.parameters.getString("ListFile").trimmed(); !file.isEmpty())
        list = MeasureList::read(absolute_path(file));
    std::shared_ptr<PointCloud> cloud;
    if (run.parameters.getBool("Snap")) {
        cloud = PointCloud::open(tree_of(run.parameters, run.document));
        options.system = coordinate_system_of(cloud->info().metadata);
    }
    const Measure measure = measure_of(run, cloud.get());
    values_of(measure);  // before anything is written
    const std::size_t added = list.add(measure);
    log_measure(run, list[added], length_unit_of(options.system));
    if (const std::string caution = caution_of(options.system); !caution.empty()) run.log("Note: " + caution + ".");
    if (output.empty()) return;
    write_measures(list, output, options);
    run.log(output.string() + ": " + grouped(list.size()) + (list.size() == 1 ? " measure" : " measures"));
}

}  // namespace

Filter measure_filter()
{
    return {
        "Measure",
        "Measures at points: the distance along them, the height, the angle, the area of a polygon, or the distance "
        "to a plane or to another surface, in double precision and with the uncertainty that the cloud's grid and "
        "spacing leave. Writes the numbers to the log and, as a list, CSV, GeoJSON or DXF, to a file.",
        MeshFilterInterface::Measure, add_parameters, run};
}

}  // namespace pcm::host
