// Numbers at points that are given, or at the points of a cloud nearest to them; and lists of measures.
#include "pcm/measure/measure.h"

#include "pcm/measure/snap.h"
#include "pcm/ops/shared/measure_report.h"
#include "pcm/ops/table.h"
#include "pcm/system/counted.h"
#include "pcm/system/new_output.h"
#include "pcm/system/text.h"
#include "pcm/system/update_file.h"

#include <algorithm>
#include <memory>

namespace pcm::ops {
namespace {

// In the order of dialogs. Volumes and profiles take a pass over clouds: they are operations of their own.
const std::vector<Choice> kinds_of_measures{{"distance", "Distance along points"},
                                            {"height", "Height between two points"},
                                            {"angle", "Angle at the second of three points"},
                                            {"area", "Area of a polygon"},
                                            {"plane", "Distance of the first point to the plane through the others"},
                                            {"surface", "Distance to a plane, cylinder, sphere, cone or torus"},
                                            {"point", "Coordinates of a point"}};

// What is to be shown and written: the measures of the list, then the new one.
MeasureList list_with(const std::string& file, const std::optional<Measure>& added)
{
    MeasureList list;
    if (!file.empty()) list = MeasureList::read(file);
    if (added) list.add(*added);
    return list;
}

class MeasurePoints : public Operation {
public:
    MeasurePoints()
    {
        arguments_.add("kind", kind_)
            .as(ValueKind::choice)
            .one_of(kinds_of_measures)
            .positional()
            .label("What to measure")
            .help(
                "point, distance (along two or more points), height (two), angle (three), area (of a polygon), plane "
                "(the first point's distance to the plane through three or more others), or surface (a point's "
                "distance to a shape that is given)");
        arguments_.add("points", points_)
            .letter('p')
            .points(3, 1, (1 << 20) / 3)
            .label("Points")
            .help("Points x0 y0 z0 x1 y1 z1 ..., source coordinates: 0 0 0 3 4 0");
        arguments_.add("snap", snap_)
            .only(Face::dialog)  // on the command line the tree that is given does it
            .label("Nearest points of the cloud")
            .help(
                "Measure at the cloud's points that are nearest to these places, at full resolution; their spacing and "
                "grid give the uncertainty. Off: at the places themselves");
        arguments_.add("from", from_)
            .as(ValueKind::file)
            .script("Tree")
            .label("Tree folder")
            .help("A tree: the points are moved to its nearest ones, whose spacing and grid give the uncertainty")
            .without("none; with 'Nearest points of the cloud' the tree that the current layer shows");
        arguments_.add("surface", surface_)
            .label("Surface")
            .help(
                "For the distance to a surface: \"plane X Y Z NX NY NZ\", \"cylinder X Y Z AX AY AZ RADIUS\", \"sphere "
                "X Y Z RADIUS\", \"cone X Y Z AX AY AZ DEGREES\" (apex, axis inwards, half the opening angle) or "
                "\"torus X Y Z AX AY AZ RADIUS TUBE\"");
        arguments_.add("name", name_).label("Name").help("Name of the measure").without("its kind and a number");
        arguments_.add("list", list_)
            .as(ValueKind::file)
            .script("ListFile")
            .label("List")
            .help("A list of measures (.json): shown, and written, before the new one")
            .without("none");
        files_.declare(arguments_);
    }

    Result answer(const Context& context) override
    {
        check(context);
        std::shared_ptr<PointCloud> cloud;
        if (!from_.empty()) cloud = context.open(from_);
        const auto system = cloud ? system_of(*cloud) : std::nullopt;
        const std::string unit = length_unit_of(system);
        double moved = 0;
        std::optional<Measure> added;
        Result result;
        if (!kind_.empty()) added = measure_of(context, cloud.get(), moved, result.notes);
        const MeasureList list = write_files(added, system);
        if (cloud) result.input = {from_};
        if (const std::string caution = caution_of(system); !caution.empty()) result.notes.push_back(caution);
        Json& values = result.values;
        values["measures"] = Json::array();
        for (std::size_t i = 0; i < list.size(); ++i) {
            values["measures"].push_back(json_of(list[i], unit));
            put_lines(result, list[i], unit);
        }
        result.accuracy = list.size() > 0 ? accuracy_of(list[list.size() - 1], unit) : exact_answer();
        values["largest_move"] = cloud ? Json(moved) : Json();
        values["unit"] = unit;
        if (cloud) result.line("places were moved to the nearest points, at most " + brief(moved));
        files_.describe(result, counted(list.size(), "measure"));
        return result;
    }

private:
    void check(const Context& context)
    {
        if (context.face == Face::dialog && !snap_) from_.clear();
        if (kind_.empty() && list_.empty())
            throw ArgumentError("what to measure: give a kind with --points, or --list FILE");
        if (kind_.empty() && !(points_.empty() && from_.empty() && surface_.empty()))
            throw ArgumentError("points are of no use without a kind of measure");
        files_.check();
        if (!list_.empty()) MeasureList::read(list_);  // refused before the work, not after it
    }

    // No point of the cloud was where the place is: the place may be one of another cloud, or mistyped.
    static void note_far_move(const SnappedPoint& snapped, std::size_t number, std::vector<std::string>& notes)
    {
        constexpr double most_spacings = 3;
        if (!(snapped.distance > most_spacings * snapped.point.spacing)) return;
        notes.push_back("place " + std::to_string(number) + " was moved by " + brief(snapped.distance) + ", to " +
                        exact(snapped.point.position) + ", where points are " + brief(snapped.point.spacing) +
                        " apart: the cloud has no point at the place that was given");
    }

    Measure measure_of(const Context& context, PointCloud* cloud, double& moved, std::vector<std::string>& notes) const
    {
        Measure measure;
        measure.kind = *measure_kind(kind_);
        measure.name = name_;
        if (!surface_.empty()) {
            if (measure.kind != MeasureKind::surface)
                throw ArgumentError(called(context, "surface") + " goes with the kind surface");
            measure.surface = parse_shape(surface_);
        }
        for (const Vec3d& place : points_of(points_, called(context, "points"))) {
            MeasuredPoint point;
            point.position = place;
            if (cloud) {
                const SnappedPoint snapped = snap(*cloud, place);
                moved = std::max(moved, snapped.distance);
                note_far_move(snapped, measure.points.size() + 1, notes);
                point = snapped.point;
            }
            measure.points.push_back(point);
        }
        values_of(measure);
        return measure;
    }

    // Writes the files, and returns the list in them: where one of them is the list that was read, what other
    // processes have added to it meanwhile is kept.
    MeasureList write_files(const std::optional<Measure>& added, const std::optional<CoordinateSystem>& system) const
    {
        MeasureList list = list_with(list_, added);
        MeasureFiles others = files_;
        for (const std::string& output : files_.outputs) {
            std::error_code none;
            if (list_.empty() || lower_extension(output) != ".json" ||
                !std::filesystem::equivalent(output, list_, none))
                continue;
            update_file(output, [&] {
                list = list_with(list_, added);
                return list.text();
            });
            others.outputs.erase(std::find(others.outputs.begin(), others.outputs.end(), output));
        }
        others.write(list, system);
        return list;
    }

    MeasureFiles files_;
    std::string kind_, name_, list_, surface_, from_;
    std::vector<double> points_;
    bool snap_ = false;
};

}  // namespace

Row measure_row()
{
    return {"measure",
            "Measure",
            "Measure at points: distance, height, angle, area, distance to a plane; lists of measures as files",
            "Measures at points: the distance along them, the height, the angle, the area of a polygon, or the "
            "distance to a plane or to another surface, in double precision and with the uncertainty that the cloud's "
            "grid and spacing leave. Writes the numbers, and, as a list, CSV, GeoJSON or DXF, files.",
            menu::measure,
            nullptr,
            {{"measures", "list", "", "for each: name, kind, values with value, uncertainty and unit, points"},
             {"largest_move", "number?", "source units",
              "largest distance by which a place was moved to a point of the tree"},
             {"unit", "text", "", "unit of lengths, as the tree states it; empty: not known"},
             {"files", "list", "", "files that were written"}},
            make<MeasurePoints>,
            {},
            "It takes neither a time limit nor an error target: the error follows from the points that are measured."};
}

}  // namespace pcm::ops
