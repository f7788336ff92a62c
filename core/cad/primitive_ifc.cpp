// Primitives and pipe runs as IFC4, ISO 16739, for programs that plan buildings and plants. Written as text: what the
// standard asks of a file that has a project, a site, a building and elements with shapes and properties is little.
#include "pcm/cad/drawing_list.h"
#include "pcm/cad/iso_text.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/shapes/shape_solids.h"
#include "pcm/system/output_file.h"

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace pcm {
namespace {

using Ref = std::string;  // "#12"

std::string list_of(const std::vector<std::string>& values)
{
    std::string text;
    for (const std::string& value : values) text += (text.empty() ? "" : ",") + value;
    return "(" + text + ")";
}

// 22 characters for 128 bits, by ISO 16739's IfcGloballyUniqueId: the same for the same name, kind and place in the
// list.
std::string global_id(const std::string& of)
{
    static const char digits[] = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_$";
    std::array<std::uint64_t, 2> halves{};
    for (std::size_t h = 0; h < 2; ++h) {
        halves[h] = 14695981039346656037u + h;  // FNV-1a
        for (const char c : of) halves[h] = (halves[h] ^ static_cast<unsigned char>(c)) * 1099511628211u;
        halves[h] ^= halves[h] >> 29;
    }
    std::string id(22, '0');
    for (std::size_t i = 22; i-- > 0;) {
        id[i] = digits[halves[1] & 63];
        halves[1] = halves[1] >> 6 | halves[0] << 58;
        halves[0] >>= 6;
    }
    return iso_string(id);
}

// The data section: each entity a line, numbered in the order in which they are added.
class IfcFile {
public:
    explicit IfcFile(OutputFile& output) : output_(output) {}

    Ref add(const std::string& entity)
    {
        const Ref ref = "#" + std::to_string(++count_);
        output_.append(ref + "=" + entity + ";\n");
        return ref;
    }
    Ref point(const Vec3d& p) { return add("IFCCARTESIANPOINT(" + numbers(p) + ")"); }
    Ref direction(const Vec3d& d) { return add("IFCDIRECTION(" + numbers(d) + ")"); }
    Ref axes(const Vec3d& place, const Vec3d& axis, const Vec3d& across)
    {
        const Ref at = point(place), along = direction(axis);
        return add("IFCAXIS2PLACEMENT3D(" + at + "," + along + "," + direction(across) + ")");
    }
    static std::string numbers(const Vec3d& v) { return list_of({iso_real(v[0]), iso_real(v[1]), iso_real(v[2])}); }

private:
    OutputFile& output_;
    std::uint64_t count_ = 0;
};

// A centre line: places, and how they are joined, two of a line or three of an arc.
struct Directrix {
    std::vector<Vec3d> places;
    std::vector<std::string> pieces;

    void line_to(const Vec3d& to)
    {
        places.push_back(to);
        pieces.push_back("IFCLINEINDEX((" + std::to_string(places.size() - 1) + "," + std::to_string(places.size()) +
                         "))");
    }
    void arc_to(const Vec3d& middle, const Vec3d& to)
    {
        places.push_back(middle);
        places.push_back(to);
        const std::size_t n = places.size();
        pieces.push_back("IFCARCINDEX((" + std::to_string(n - 2) + "," + std::to_string(n - 1) + "," +
                         std::to_string(n) + "))");
    }
    // The arc about an axis through a centre, in parts of half a turn at most: three places say no more than that well.
    void turn(const Vec3d& centre, const Vec3d& axis, double angle)
    {
        const Vec3d u = places.back() - centre, v = cross(axis, u);
        const auto at = [&](double a) { return centre + std::cos(a) * u + std::sin(a) * v; };
        const double parts = std::ceil(angle / pi - 1e-9);
        for (double k = 0; k < parts; ++k) arc_to(at(angle * (k + 0.5) / parts), at(angle * (k + 1) / parts));
    }
};

// Shapes as representation items, about a place near them: coordinates of a map have too many digits for the single
// precision in which many programs draw.
class IfcSolids : public ShapeSolids {
public:
    IfcSolids(IfcFile& file, const Vec3d& origin) : file_(file), origin_(origin) {}

    void face(const Vec3d& /*point*/, const Vec3d& /*normal*/, const std::vector<Vec3d>& corners) override
    {
        std::vector<Ref> points;
        for (const Vec3d& corner : corners) points.push_back(file_.point(corner - origin_));
        const Ref loop = file_.add("IFCPOLYLOOP(" + list_of(points) + ")");
        const Ref bound = file_.add("IFCFACEOUTERBOUND(" + loop + ",.T.)");
        const Ref shell = file_.add("IFCOPENSHELL((" + file_.add("IFCFACE((" + bound + "))") + "))");
        take("IFCSHELLBASEDSURFACEMODEL((" + shell + "))", "SurfaceModel");
    }

    // A polygon from the axis outwards and back, turned about the axis.
    void frustum(const Vec3d& base, const Vec3d& axis, double radius, double other_radius, double length) override
    {
        std::vector<Ref> points;
        const auto corner = [&](double from_axis, double along) {
            points.push_back(file_.add("IFCCARTESIANPOINT(" + list_of({iso_real(from_axis), iso_real(along)}) + ")"));
        };
        corner(0, 0);
        if (radius > 0) corner(radius, 0);
        if (other_radius > 0) corner(other_radius, length);
        corner(0, length);
        points.push_back(points.front());
        const Ref outline = file_.add("IFCPOLYLINE(" + list_of(points) + ")");
        const Ref profile = file_.add("IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$," + outline + ")");
        // The profile's y is the axis of the frustum.
        const Vec3d across = AxisFrame(axis).u;
        const Ref place = file_.axes(base - origin_, cross(across, axis), across);
        const Ref zero = file_.point({0, 0, 0});
        const Ref turned = file_.add("IFCAXIS1PLACEMENT(" + zero + "," + file_.direction({0, 1, 0}) + ")");
        take("IFCREVOLVEDAREASOLID(" + profile + "," + place + "," + turned + "," + iso_real(2 * pi) + ")",
             "SweptSolid");
    }

    void ball(const Vec3d& centre, double radius) override
    {
        const Ref place = file_.axes(centre - origin_, {0, 0, 1}, {1, 0, 0});
        take("IFCCSGSOLID(" + file_.add("IFCSPHERE(" + place + "," + iso_real(radius) + ")") + ")", "CSG");
    }

    void ring(const Vec3d& centre, const Vec3d& axis, const Vec3d& zero, double radius, double tube_radius,
              double arc) override
    {
        Directrix line;
        line.places.push_back(centre + radius * zero);
        line.turn(centre, axis, arc);
        tube(line, tube_radius);
    }

    void tube(const Directrix& line, double radius)
    {
        std::vector<std::string> places;
        for (const Vec3d& place : line.places) places.push_back(IfcFile::numbers(place - origin_));
        const Ref points = file_.add("IFCCARTESIANPOINTLIST3D(" + list_of(places) + ")");
        const Ref curve = file_.add("IFCINDEXEDPOLYCURVE(" + points + "," + list_of(line.pieces) + ",.F.)");
        take("IFCSWEPTDISKSOLID(" + curve + "," + iso_real(radius) + ",$,$,$)", "AdvancedSweptSolid");
    }

    Ref item;
    std::string type;  // name of the representation's type

private:
    void take(const std::string& entity, const char* representation)
    {
        item = file_.add(entity);
        type = representation;
    }

    IfcFile& file_;
    const Vec3d origin_;
};

Ref ifc_length_unit(IfcFile& file, CadUnit unit)
{
    const auto si = [&](const char* prefix) {
        return file.add("IFCSIUNIT(*,.LENGTHUNIT.," + std::string(prefix) + ",.METRE.)");
    };
    const auto converted = [&](const char* name, double metres) {
        const Ref factor = file.add("IFCMEASUREWITHUNIT(IFCLENGTHMEASURE(" + iso_real(metres) + ")," + si("$") + ")");
        const Ref exponents = file.add("IFCDIMENSIONALEXPONENTS(1,0,0,0,0,0,0)");
        return file.add("IFCCONVERSIONBASEDUNIT(" + exponents + ",.LENGTHUNIT.," + iso_string(name) + "," + factor +
                        ")");
    };
    switch (unit) {
        case CadUnit::millimetres:
            return si(".MILLI.");
        case CadUnit::centimetres:
            return si(".CENTI.");
        case CadUnit::feet:
            return converted("FOOT", 0.3048);
        case CadUnit::inches:
            return converted("INCH", 0.0254);
        case CadUnit::none:
        case CadUnit::metres:
            break;
    }
    return si("$");
}

// The project, with its site at `origin` and a building in it; elements are added to the building.
class IfcProject {
public:
    IfcProject(IfcFile& file, CadUnit unit, const Vec3d& origin) : file_(file), solids_(file, origin)
    {
        const Ref world = file.axes({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
        context_ = file.add("IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-9," + world + ",$)");
        const Ref length = ifc_length_unit(file, unit), angle = file.add("IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.)");
        const Ref units = file.add("IFCUNITASSIGNMENT(" + list_of({length, angle}) + ")");
        const Ref project = file.add("IFCPROJECT(" + global_id("project") + ",$,'Point cloud',$,$,$,$,(" + context_ +
                                     ")," + units + ")");
        const Ref at_origin = file.axes(origin, {0, 0, 1}, {1, 0, 0});
        const Ref site_place = file.add("IFCLOCALPLACEMENT($," + at_origin + ")");
        const Ref site =
            file.add("IFCSITE(" + global_id("site") + ",$,'Site',$,$," + site_place + ",$,$,.ELEMENT.,$,$,$,$,$)");
        place_ = file.add("IFCLOCALPLACEMENT(" + site_place + "," + world + ")");
        building_ =
            file.add("IFCBUILDING(" + global_id("building") + ",$,'Building',$,$," + place_ + ",$,$,.ELEMENT.,$,$,$)");
        file.add("IFCRELAGGREGATES(" + global_id("sites") + ",$,$,$," + project + ",(" + site + "))");
        file.add("IFCRELAGGREGATES(" + global_id("buildings") + ",$,$,$," + site + ",(" + building_ + "))");
    }

    IfcSolids& solids() { return solids_; }

    // What `solids()` was given last, as an element of a class.
    using Properties = std::vector<std::pair<std::string, std::string>>;  // names, and values such as IFCREAL(1.)
    void element(const char* ifc_class, const char* predefined, const std::string& name,
                 const std::array<std::uint8_t, 3>& colour, const Properties& properties)
    {
        const std::string id = std::to_string(elements_.size()) + " " + name;
        std::vector<std::string> rgb;
        for (const std::uint8_t c : colour) rgb.push_back(iso_real(c / 255.0));
        const Ref shade = file_.add("IFCSURFACESTYLESHADING(" +
                                    file_.add("IFCCOLOURRGB($," + rgb[0] + "," + rgb[1] + "," + rgb[2] + ")") + ",$)");
        const Ref style = file_.add("IFCSURFACESTYLE($,.BOTH.,(" + shade + "))");
        file_.add("IFCSTYLEDITEM(" + solids_.item + ",(" + style + "),$)");
        const Ref shape = file_.add("IFCSHAPEREPRESENTATION(" + context_ + ",'Body'," + iso_string(solids_.type) +
                                    ",(" + solids_.item + "))");
        const Ref whole = file_.add("IFCPRODUCTDEFINITIONSHAPE($,$,(" + shape + "))");
        const Ref placed =
            file_.add("IFCLOCALPLACEMENT(" + place_ + "," + file_.axes({0, 0, 0}, {0, 0, 1}, {1, 0, 0}) + ")");
        elements_.push_back(file_.add(std::string(ifc_class) + "(" + global_id(id) + ",$," + iso_label(name) + ",$,$," +
                                      placed + "," + whole + ",$," + predefined + ")"));
        std::vector<Ref> values;
        for (const auto& [key, value] : properties)
            values.push_back(file_.add("IFCPROPERTYSINGLEVALUE(" + iso_string(key) + ",$," + value + ",$)"));
        const Ref set = file_.add("IFCPROPERTYSET(" + global_id(id + " set") + ",$,'Fit',$," + list_of(values) + ")");
        file_.add("IFCRELDEFINESBYPROPERTIES(" + global_id(id + " has") + ",$,$,$,(" + elements_.back() + ")," + set +
                  ")");
    }

    void end()
    {
        file_.add("IFCRELCONTAINEDINSPATIALSTRUCTURE(" + global_id("elements") + ",$,$,$," + list_of(elements_) + "," +
                  building_ + ")");
    }

private:
    IfcFile& file_;
    IfcSolids solids_;
    Ref context_, place_, building_;
    std::vector<Ref> elements_;
};

std::string length_value(double v) { return "IFCLENGTHMEASURE(" + iso_real(v) + ")"; }
std::string count_value(std::uint64_t v) { return "IFCINTEGER(" + std::to_string(v) + ")"; }

IfcProject::Properties properties_of(const Primitive& primitive)
{
    const ShapeFit& fit = primitive.fit;
    IfcProject::Properties properties;
    for (const ShapeSize& size : traits_of(fit.shape.kind).sizes) {
        const bool is_length = size.unit == SizeUnit::length;
        const auto value = [&](double v) {
            return is_length ? length_value(v) : "IFCPLANEANGLEMEASURE(" + iso_real(v) + ")";
        };
        properties.emplace_back(size.name, value(fit.shape.*size.value));
        const double error = fit.errors.*size.error;
        if (error > 0 && std::isfinite(error))
            properties.emplace_back(std::string(size.name) + ", standard deviation", value(error));
    }
    if (primitive.points > 0) properties.emplace_back("points", count_value(primitive.points));
    if (fit.rms > 0) properties.emplace_back("rms", length_value(fit.rms));
    properties.emplace_back("verdict", "IFCLABEL(" + iso_string(name_of(fit.verdict)) + ")");
    return properties;
}

IfcProject::Properties properties_of(const PipeRun& run)
{
    IfcProject::Properties properties{{"radius", length_value(run.radius)}};
    if (run.radius_error > 0) properties.emplace_back("radius, standard deviation", length_value(run.radius_error));
    properties.emplace_back("length", length_value(run.length()));
    properties.emplace_back("bends", count_value(run.bends()));
    for (std::size_t i = 0; i < run.parts.size(); ++i)
        properties.emplace_back("part " + std::to_string(i + 1), "IFCLABEL(" + iso_label(run.parts[i]->name) + ")");
    return properties;
}

Directrix directrix_of(const PipeRun& run)
{
    Directrix line;
    line.places.push_back(run.line.front().from);
    for (const CentrePiece& piece : run.line) {
        if (piece.is_bend())
            line.turn(piece.centre, piece.axis, piece.angle);
        else
            line.line_to(piece.to);
    }
    return line;
}

// Whole units near the first shape.
Vec3d origin_of(const DrawingList& list)
{
    Vec3d origin = list.shown.front()->fit.shape.point;
    for (double& c : origin) c = std::floor(c);
    return origin;
}

}  // namespace

void write_ifc(const std::filesystem::path& file, DrawingList& list, const CadOptions& options)
{
    OutputFile output(file);
    output.append(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('ViewDefinition [DesignTransferView]'),'2;1');\nFILE_NAME(" +
        iso_string(file.filename().string()) +
        ",'',(''),(''),'pcmlab','pcmlab','');\nFILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n");
    IfcFile data(output);
    IfcProject project(data, options.unit, origin_of(list));
    std::set<const Primitive*> parts;
    for (const PipeRun& run : list.runs) {
        parts.insert(run.parts.begin(), run.parts.end());
        project.solids().tube(directrix_of(run), run.radius);
        project.element("IFCPIPESEGMENT", ".RIGIDSEGMENT.", run.name, run.parts.front()->colour, properties_of(run));
    }
    for (const Primitive* primitive : list.shown) {
        if (parts.count(primitive)) continue;
        const Shape& shape = primitive->fit.shape;
        traits_of(shape.kind).solid(shape, primitive->bounds, project.solids());
        const bool is_plane = shape.kind == ShapeKind::plane;
        project.element(is_plane ? "IFCPLATE" : "IFCBUILDINGELEMENTPROXY", is_plane ? ".NOTDEFINED." : "$",
                        primitive->name, primitive->colour, properties_of(*primitive));
    }
    project.end();
    output.append("ENDSEC;\nEND-ISO-10303-21;\n");
    output.finish();
    list.note_unit(options.unit, "an IFC file");
    if (!parts.empty())
        list.notes.emplace_back(std::to_string(parts.size()) + " primitives are in the pipe runs, as parts of them");
}

}  // namespace pcm
