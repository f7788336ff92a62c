#include "plugin/meshlab/points_layer.h"

#include "pcm/cloud/vector.h"
#include "plugin/meshlab/layer.h"
#include "plugin/meshlab/meshlab.h"
#include "plugin/meshlab/vertex_attributes.h"
#include "plugin/scene/origin.h"
#include "plugin/scene/proxy.h"
#include "plugin/scene/text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

namespace pcm::host {

namespace {

using Held = AttributePlace::Held;
using Kind = AttributePlace::Kind;

constexpr std::array<std::uint8_t, 3> grey{191, 191, 191};
constexpr double largest_whole = 9007199254740992.0;  // 2^53: double represents all integers up to here

// All points of a file in memory.
struct Points {
    std::vector<Vec3d> positions;
    std::vector<Column> columns;
    Box3d box;
    std::uint64_t skipped = 0;  // without a finite position
};

void append(Column& to, const Column& from, const std::vector<std::size_t>& chosen)
{
    const std::size_t bytes = to.point_bytes(), before = to.size();
    to.resize(before + chosen.size());
    std::byte* out = to.data() + before * bytes;
    for (const std::size_t i : chosen) {
        std::memcpy(out, from.data() + i * bytes, bytes);
        out += bytes;
    }
}

// Nothing if there are more than `most`.
std::optional<Points> read_all(PointReader& reader, std::uint64_t most, const ProgressFunction& progress)
{
    const FileInfo& info = reader.info();
    if (info.points_known && info.points > most) return std::nullopt;
    Points points;
    for (const Attribute& attribute : info.schema) points.columns.emplace_back(attribute);
    PointBatch batch;
    std::vector<std::size_t> finite;
    while (reader.read(batch, default_batch_points)) {
        finite.clear();
        for (std::size_t i = 0; i < batch.size; ++i) {
            Vec3d p;
            for (std::size_t a = 0; a < 3; ++a)
                p[a] = batch.gridded ? info.grid->to_source(batch.grid_xyz[a][i], a) : batch.xyz[a][i];
            if (!is_finite(p)) {
                ++points.skipped;
                continue;
            }
            finite.push_back(i);
            points.positions.push_back(p);
            points.box.extend(p);
        }
        if (points.positions.size() > most) return std::nullopt;
        for (std::size_t c = 0; c < points.columns.size(); ++c) append(points.columns[c], batch.attributes[c], finite);
        if (progress && !progress({"Reading points", reader.fraction_read(), -1}))
            throw Error(ErrorCode::cancelled, {}, "cancelled");
    }
    if (points.positions.empty()) throw Error(ErrorCode::bad_format, {}, "the file has no points");
    return points;
}

// A name that MeshLab's expressions accept as a variable and do not define themselves.
std::string variable_name(const std::string& name, const std::set<std::string>& taken)
{
    static const std::set<std::string> reserved{"x", "y",   "z",  "nx",  "ny",  "nz", "r",    "g", "b", "a",
                                                "q", "rad", "vi", "vtu", "vtv", "ti", "vsel", "e", "pi"};
    std::string variable;
    for (const char c : name)
        variable += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
    if (variable.empty() || (variable[0] >= '0' && variable[0] <= '9')) variable = "_" + variable;
    if (reserved.count(variable)) variable += '_';
    std::string unique = variable;
    for (int i = 2; taken.count(unique); ++i) unique = variable + "_" + std::to_string(i);
    return unique;
}

Held choose_held(const Column& column, std::uint32_t component, const Attribute& attribute)
{
    const bool is_long = attribute.type == ScalarType::i64 || attribute.type == ScalarType::u64;
    bool value_fits = true, whole_fits = true;
    for (std::size_t i = 0; i < column.size(); ++i) {
        const double raw = column.value(i, component);
        const auto shown = static_cast<Scalar>(raw * attribute.scale + attribute.offset);
        value_fits = value_fits && (std::isnan(raw) || raw_of(shown, attribute) == raw);
        whole_fits = whole_fits && !(std::fabs(raw) >= largest_whole);
    }
    // `raw` is rounded from there on, whatever holds it.
    if (value_fits && (whole_fits || !is_long)) return Held::value;
    if (attribute.type == ScalarType::i64 && !whole_fits) return Held::i64;
    if (attribute.type == ScalarType::u64 && !whole_fits) return Held::u64;
    return Held::f64;
}

template <class T, class Value>
void fill(MeshModel& layer, const std::string& name, std::size_t points, const Value& value)
{
    OwnedAttribute<T>& attribute = add_vertex_attribute<T>(layer, name);
    for (std::size_t i = 0; i < points; ++i) attribute[i] = static_cast<T>(value(i));
}

AttributePlace put_custom(MeshModel& layer, const Attribute& attribute, const Column& column,
                          std::set<std::string>& taken)
{
    AttributePlace place;
    std::vector<Held> held;
    for (std::uint32_t c = 0; c < attribute.components; ++c) held.push_back(choose_held(column, c, attribute));
    for (const Held whole : {Held::i64, Held::u64})  // the same for all components
        if (std::find(held.begin(), held.end(), whole) != held.end()) held.assign(held.size(), whole);
    for (std::uint32_t c = 0; c < attribute.components; ++c) {
        const std::string name = attribute.components == 1 ? attribute.name : attribute.name + "_" + std::to_string(c);
        AttributePlace::Component component{variable_name(name, taken), held[c]};
        taken.insert(component.name);
        const std::size_t n = column.size(), step = column.components();
        const auto raw = [&](std::size_t i) { return column.value(i, c); };
        const bool is_raw = attribute.scale == 1 && attribute.offset == 0;
        switch (component.held) {
            case Held::value:
                fill<Scalar>(layer, component.name, n, [&](std::size_t i) {
                    // The sum would make 0 of -0.
                    return is_raw ? raw(i) : raw(i) * attribute.scale + attribute.offset;
                });
                break;
            case Held::f64:
                fill<double>(layer, component.name, n, raw);
                break;
            case Held::i64:
                fill<std::int64_t>(layer, component.name, n,
                                   [&](std::size_t i) { return column.as<std::int64_t>()[i * step + c]; });
                break;
            case Held::u64:
                fill<std::uint64_t>(layer, component.name, n,
                                    [&](std::size_t i) { return column.as<std::uint64_t>()[i * step + c]; });
                break;
        }
        place.components.push_back(std::move(component));
    }
    return place;
}

Kind kind_of(const Attribute& attribute)
{
    if (attribute.name == attribute_name::rgb && attribute.components == 3) return Kind::colour;
    if (attribute.name == attribute_name::normal && attribute.components == 3) return Kind::normal;
    if (attribute.name == attribute_name::intensity && attribute.components == 1) return Kind::quality;
    if (attribute.name == attribute_name::radius && attribute.components == 1) return Kind::radius;
    return Kind::custom;
}

bool is_shown_exactly(const Column& column, const Attribute& attribute)
{
    for (std::uint32_t c = 0; c < column.components(); ++c)
        if (choose_held(column, c, attribute) != Held::value) return false;
    return true;
}

std::string list(const std::vector<std::string>& names)
{
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

// All of MeshLab's vertex members but position and colour.
void set_members(MeshModel& layer, const LayerSource& source, const Points& points)
{
    for (std::size_t s = 0; s < source.places.size(); ++s) {
        const Column& column = points.columns[s];
        const Attribute& attribute = source.info.schema[s];
        const auto shown = [&](std::size_t i, std::uint32_t c = 0) {
            return static_cast<Scalarm>(column.value(i, c) * attribute.scale + attribute.offset);
        };
        const Kind kind = source.places[s].kind;
        if (kind == Kind::normal) layer.updateDataMask(MeshModel::MM_VERTNORMAL);
        if (kind == Kind::quality) layer.updateDataMask(MeshModel::MM_VERTQUALITY);
        if (kind == Kind::radius) layer.updateDataMask(MeshModel::MM_VERTRADIUS);
        for (std::size_t i = 0; i < column.size(); ++i) {
            auto& vertex = layer.cm.vert[i];
            if (kind == Kind::normal) vertex.N() = Point3m(shown(i, 0), shown(i, 1), shown(i, 2));
            if (kind == Kind::quality) vertex.Q() = shown(i);
            if (kind == Kind::radius) vertex.R() = shown(i);
        }
    }
}

// The column that colours are made from: rgb unless all points are black, else intensity, else none.
std::optional<std::size_t> colour_slot(const LayerSource& source, const Points& points)
{
    std::optional<std::size_t> intensity;
    for (std::size_t s = 0; s < source.places.size(); ++s) {
        if (source.places[s].kind == Kind::colour && !is_black(points.columns[s])) return s;
        if (source.places[s].kind == Kind::quality) intensity = s;
    }
    return intensity;
}

void set_vertices(MeshModel& layer, LayerSource& source, const Points& points)
{
    const auto slot = colour_slot(source, points);
    std::vector<std::array<std::uint8_t, 3>> colours;
    std::optional<std::size_t> rgb;
    for (std::size_t s = 0; s < source.places.size(); ++s)
        if (source.places[s].kind == Kind::colour) rgb = s;
    if (rgb) source.colour_scale = ColourScale::of(points.columns[*rgb], ColourSource::rgb);
    if (slot) colours = colours_of(points.columns[*slot], slot == rgb);

    OwnedAttribute<KeptVertex>& kept = add_vertex_attribute<KeptVertex>(layer, kept_vertices);
    layer.updateDataMask(MeshModel::MM_VERTCOLOR);
    for (std::size_t i = 0; i < points.positions.size(); ++i) {
        auto& vertex = layer.cm.vert[i];
        KeptVertex& own = kept[i];
        own.position = points.positions[i];
        own.colour = slot ? colours[i] : grey;
        if (rgb)
            for (std::uint32_t c = 0; c < 3; ++c) own.rgb[c] = static_cast<float>(points.columns[*rgb].value(i, c));
        const ScalarPosition local = local_position(own.position, source.origin);
        vertex.P() = Point3m(local[0], local[1], local[2]);
        vertex.C() = vcg::Color4b(own.colour[0], own.colour[1], own.colour[2], 255);
    }
}

std::vector<std::string> log_lines(const LayerSource& source, const Points& points)
{
    const FileInfo& info = source.info;
    std::vector<std::string> lines{grouped(points.positions.size()) + " points, " + info.format + ".",
                                   origin_line(source.origin)};
    lines.push_back(rounding_line(points.box, source.origin, "The layer") +
                    " Exporting writes the exact coordinates of the file for points that were not moved.");
    if (points.skipped) lines.push_back(grouped(points.skipped) + " points without a finite position were left out.");

    std::vector<std::string> members, variables, others, rounded;
    for (std::size_t s = 0; s < source.places.size(); ++s) {
        const AttributePlace& place = source.places[s];
        const Attribute& attribute = info.schema[s];
        if (place.kind == Kind::quality) members.emplace_back("intensity as quality");
        if (place.kind == Kind::normal) members.emplace_back("normals");
        if (place.kind == Kind::radius) members.emplace_back("radius");
        if (place.kind == Kind::colour)
            members.emplace_back(
                attribute.type == ScalarType::u8
                    ? "colours"
                    : "colours, shown with 8 bits (exporting writes the file's values where unchanged)");
        if (place.kind != Kind::custom && place.kind != Kind::colour && !is_shown_exactly(points.columns[s], attribute))
            rounded.push_back(attribute.name);
        if (place.kind == Kind::colour && attribute.type != ScalarType::f32 && size_of(attribute.type) > 2)
            rounded.push_back(attribute.name);
        for (const AttributePlace::Component& component : place.components)
            (component.held == Held::value ? variables : others).push_back(component.name);
    }
    if (!members.empty()) lines.push_back("Vertices have " + list(members) + ".");
    if (!variables.empty()) lines.push_back("Vertex attributes: " + list(variables) + ".");
    if (!others.empty())
        lines.push_back("Kept for export only, as MeshLab's float attributes would round them: " + list(others) + ".");
    if (!rounded.empty()) lines.push_back("Rounded to float: " + list(rounded) + ".");
    lines.insert(lines.end(), info.notes.begin(), info.notes.end());
    return lines;
}

}  // namespace

std::optional<std::vector<std::string>> load_points(MeshModel& layer, PointReader& reader, std::uint64_t most_points,
                                                    const ProgressFunction& progress,
                                                    const std::function<void(const Box3d&)>& on_box)
{
    std::optional<Points> points = read_all(reader, most_points, progress);
    if (!points) return std::nullopt;
    if (on_box) on_box(points->box);
    auto source = std::make_shared<LayerSource>();
    source->info = reader.info();
    source->origin = Registry::instance().origin_for(document_of(layer), points->box);

    clear_layer(layer);
    vcg::tri::Allocator<CMeshO>::AddVertices(layer.cm, points->positions.size());
    std::set<std::string> taken{kept_vertices};
    for (std::size_t s = 0; s < source->info.schema.size(); ++s) {
        const Attribute& attribute = source->info.schema[s];
        AttributePlace place;
        place.kind = kind_of(attribute);
        if (place.kind == Kind::custom) {
            place = put_custom(layer, attribute, points->columns[s], taken);
            points->columns[s] = Column(attribute);  // frees its memory
        }
        source->places.push_back(std::move(place));
    }
    set_members(layer, *source, *points);
    set_vertices(layer, *source, *points);
    vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
    std::vector<std::string> lines = log_lines(*source, *points);
    Registry::instance().set_source(layer, source);
    return lines;
}

}  // namespace pcm::host
