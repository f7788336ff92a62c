#include "pcm/gl/draw/vertex_maker.h"

#include "pcm/cloud/vector.h"
#include "pcm/view/depth_steps.h"
#include "pcm/view/point_shapes.h"
#include "pcm/view/vertex_discs.h"

#include <string>
#include <utility>

namespace pcm {

std::uint64_t selection_number(const PointSet& selected, NodeId node)
{
    if (selected.count(node) == 0) return 0;
    std::uint64_t number = selected.count(node);
    for (const std::uint32_t point : selected.has_all(node) ? std::vector<std::uint32_t>{} : selected.points(node)) {
        number = (number ^ point) * 0x9e3779b97f4a7c15u;
        number ^= number >> 29;
    }
    return number == 0 ? 1 : number;
}

struct VertexMaker::Values {
    VertexAttributes attributes;
    std::vector<std::uint8_t> rgba, flags;
    std::vector<float> numbers, radii, normals, steps;  // steps: empty where there are none
    std::vector<PointShape> shapes;
    ClassSet classes;
};

VertexMaker::VertexMaker(VertexRecipe recipe) : recipe_(std::move(recipe)) {}

ColumnSet VertexMaker::columns_kept() const
{
    const VertexFormat& format = recipe_.format;
    std::vector<std::string> names;
    if (format.radius) names.emplace_back(attribute_name::radius);
    if (format.normal || format.shape) names.emplace_back(attribute_name::normal);
    ColumnSet columns = ColumnSet::named(recipe_.tree->info().schema, names);
    columns.sizes = format.radius;
    if (recipe_.colour) columns.attributes.set(recipe_.colour->attribute);
    return columns;
}

ColumnSet VertexMaker::columns() const
{
    ColumnSet columns = columns_kept();
    if (recipe_.filter) columns |= recipe_.filter->tested();
    return columns;
}

MadeVertices VertexMaker::make(NodeId node, const Chunk& chunk) const
{
    const Grid& grid = recipe_.tree->info().grid;
    const auto points = recipe_.filter ? recipe_.filter->shown(chunk, grid) : std::nullopt;
    const std::vector<std::uint32_t>* const shown_points = points ? &*points : nullptr;
    const Chunk shown = points ? ChunkFilter::take(chunk, *points, columns_kept()) : chunk;
    Values values;
    if (recipe_.format.shape) find_shapes_of(node, chunk, shown_points, values);
    find_attributes(node, shown, values);
    find_flags(node, shown_points, values);
    MadeVertices made;
    made.vertices =
        make_vertices(*shown.positions, grid.scale, recipe_.format, values.attributes, chunk.points - shown.points);
    made.classes = values.classes;
    return made;
}

void VertexMaker::find_colours(const Chunk& chunk, Values& values) const
{
    const Column& column = *chunk.attributes[recipe_.colour->attribute];
    const Attribute& attribute = recipe_.tree->info().schema[recipe_.colour->attribute];
    if (is_value(recipe_.format.colour)) {
        make_values(column, attribute, recipe_.colour->component, recipe_.range.low, recipe_.range.high,
                    values.numbers);
        values.attributes.colours = reinterpret_cast<const std::uint8_t*>(values.numbers.data());
        return;
    }
    if (recipe_.format.colour == ColourSource::rgb) {
        make_colours(column, recipe_.scale, values.rgba);
    } else {
        make_class_colours(column, attribute, values.rgba);
        add_classes(column, attribute, values.classes);
    }
    values.attributes.colours = values.rgba.data();
}

void VertexMaker::find_attributes(NodeId node, const Chunk& chunk, Values& values) const
{
    const VertexFormat& format = recipe_.format;
    const Schema& schema = recipe_.tree->info().schema;
    if (recipe_.colour) find_colours(chunk, values);
    if (format.radius) {
        if (format.shape) use_own_normals(chunk, values);
        recipe_.sizes->find_radii(node, chunk, values.radii, format.shape ? &values.shapes : nullptr);
        values.attributes.radii = values.radii.data();
        for (std::size_t i = 0; i < values.steps.size(); ++i)
            values.shapes[i] = with_steps(values.shapes[i], static_cast<double>(values.steps[i]),
                                          static_cast<double>(values.radii[i]));
        if (format.shape) values.attributes.shapes = values.shapes.data();
    }
    if (format.normal) {
        const std::size_t place = *schema.find(attribute_name::normal);
        make_normals(*chunk.attributes[place], schema[place], values.normals);
        values.attributes.normals = values.normals.data();
    }
}

// Shapes of these points, null for all.
void VertexMaker::find_shapes_of(NodeId node, const Chunk& whole, const std::vector<std::uint32_t>* points,
                                 Values& values) const
{
    std::vector<PointShape>& shapes = values.shapes;
    const Vec3d& scale = recipe_.tree->info().grid.scale;
    find_shapes(*whole.positions, scale, points_of_segments(recipe_.tree->node(node)), shapes);
    values.steps = find_depth_steps(*whole.positions, scale, recipe_.tree->node(node).level_points);
    if (!points) return;
    const auto take = [&](auto& of_all) {
        if (of_all.empty()) return;
        for (std::size_t i = 0; i < points->size(); ++i) of_all[i] = of_all[(*points)[i]];
        of_all.resize(points->size());
    };
    take(shapes);
    take(values.steps);
}

// Replaces shapes by the points' own normals, where there are some.
void VertexMaker::use_own_normals(const Chunk& chunk, Values& values) const
{
    const Schema& schema = recipe_.tree->info().schema;
    const auto normal = schema.find(attribute_name::normal), radius = schema.find(attribute_name::radius);
    if (!normal || schema[*normal].components < 3) return;
    make_normals(*chunk.attributes[*normal], schema[*normal], values.normals);
    values.radii.assign(chunk.points, 0);
    if (radius) make_radii(*chunk.attributes[*radius], schema[*radius], values.radii);
    for (std::size_t i = 0; i < chunk.points; ++i) {
        const Vec3d n{static_cast<double>(values.normals[3 * i]), static_cast<double>(values.normals[3 * i + 1]),
                      static_cast<double>(values.normals[3 * i + 2])};
        // Among leaves a normal describes a leaf, if there is a radius with it.
        if (dot(n, n) > 0 && (values.radii[i] > 0 || surroundings_of(values.shapes[i]) != Surroundings::volume))
            values.shapes[i] = shape_of(Surroundings::surface, n);
    }
}

// Whether these points of the node, null for all, are selected.
void VertexMaker::find_flags(NodeId node, const std::vector<std::uint32_t>* points, Values& values) const
{
    values.attributes.selection = recipe_.selected ? selection_number(*recipe_.selected, node) : 0;
    if (!values.attributes.selection) return;
    std::vector<std::uint8_t>& flags = values.flags;
    flags = recipe_.selected->flags(node);
    for (std::size_t i = 0; points && i < points->size(); ++i) flags[i] = flags[(*points)[i]];
    values.attributes.selected = flags.data();
}

}  // namespace pcm
