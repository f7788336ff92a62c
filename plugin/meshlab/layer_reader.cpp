#include "plugin/meshlab/layer_reader.h"

#include "pcm/cloud/with_type.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/unique_name.h"
#include "pcm/system/error.h"
#include "plugin/meshlab/meshlab.h"
#include "plugin/meshlab/registry.h"
#include "plugin/meshlab/vertex_attributes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcm::host {

namespace {

using Held = AttributePlace::Held;
using Kind = AttributePlace::Kind;

template <class T>
bool fits(double value)
{
    if constexpr (std::is_integral_v<T>)
        return value >= static_cast<double>(std::numeric_limits<T>::min()) &&
               value <= static_cast<double>(std::numeric_limits<T>::max()) && value == std::floor(value) &&
               std::fabs(value) <= 9007199254740992.0;  // 2^53
    else
        return std::isnan(value) || static_cast<double>(static_cast<T>(value)) == value;
}

bool is_whole(ScalarType type) { return type != ScalarType::f32 && type != ScalarType::f64; }

}  // namespace

LayerReader::LayerReader(const MeshModel& layer, const LayerSelection& selection)
    : layer_(layer), source_(Registry::instance().source_of(layer))
{
    const auto& vertices = layer.cm.vert;
    for (std::size_t i = 0; i < vertices.size(); ++i)
        if (!vertices[i].IsD() && (!selection.selected_only || vertices[i].IsS())) vertices_.push_back(i);
    if (vertices_.empty())
        throw Error(ErrorCode::invalid_argument, {},
                    std::string("the layer '") + layer.label().toStdString() +
                        (selection.selected_only ? "' has no selected vertices" : "' has no vertices"),
                    selection.selected_only ? "select some, or export all" : "");
    if (source_) kept_ = find_vertex_attribute<KeptVertex>(layer, kept_vertices);
    origin_ = source_ ? source_->origin : Registry::instance().origin_of(document_of(layer)).value_or(Vec3d{0, 0, 0});

    info_.format = "layer";
    info_.points = vertices_.size();
    if (source_) info_.metadata = source_->info.metadata;
    if (source_) source_grid_ = source_->info.grid ? source_->info.grid : source_->info.near_grid;
    if (source_)
        add_file_fields(selection);
    else
        add_member_fields(layer, selection);
    add_free_fields(layer);
    settle_positions();
}

bool LayerReader::is_unmoved(std::size_t vertex) const
{
    const Point3m& present = layer_.cm.vert[vertex].cP();
    return kept_ &&
           local_position(kept_[vertex].position, origin_) == ScalarPosition{present[0], present[1], present[2]};
}

Vec3d LayerReader::position(std::size_t vertex) const
{
    if (is_unmoved(vertex)) return kept_[vertex].position;
    const auto& p = layer_.cm.vert[vertex].cP();
    return {static_cast<double>(p[0]) + origin_[0], static_cast<double>(p[1]) + origin_[1],
            static_cast<double>(p[2]) + origin_[2]};
}

// On the file's grid if all points lie on it; in float if float represents them exactly and the file had float; else in
// double.
void LayerReader::settle_positions()
{
    bool on_grid = source_grid_.has_value();
    bool in_float = !source_ || source_->info.position_type == ScalarType::f32;
    for (const std::size_t v : vertices_) {
        const Vec3d p = position(v);
        moved_ += !is_unmoved(v);
        for (std::size_t a = 0; a < 3; ++a) {
            in_float = in_float && fits<float>(p[a]);
            if (!on_grid) continue;
            const double q = std::round((p[a] - source_grid_->offset[a]) / source_grid_->scale[a]);
            on_grid = fits<std::int32_t>(q) && source_grid_->to_source(static_cast<std::int64_t>(q), a) == p[a];
        }
    }
    (on_grid ? info_.grid : info_.near_grid) = source_grid_;
    info_.position_type = on_grid ? ScalarType::i32 : in_float ? ScalarType::f32 : ScalarType::f64;
}

// The field keeps its type if all values fit; else it becomes the number that MeshLab shows.
void LayerReader::add_field(Field field, bool may_widen)
{
    field.attribute.name = unique_name(info_.schema, field.attribute.name);
    bool fit = true;
    if (field.whole.empty() && may_widen)
        for (const std::size_t v : vertices_)
            for (std::uint32_t c = 0; fit && c < field.attribute.components; ++c)
                fit =
                    with_type(field.attribute.type, [&](auto zero) { return fits<decltype(zero)>(field.value(v, c)); });
    if (!fit) {
        const Attribute raw = field.attribute;
        field.attribute.type = in_double ? ScalarType::f64 : ScalarType::f32;
        field.attribute.scale = 1;
        field.attribute.offset = 0;
        field.value = [value = std::move(field.value), raw](std::size_t v, std::uint32_t c) {
            return value(v, c) * raw.scale + raw.offset;
        };
    }
    info_.schema.add(field.attribute);
    fields_.push_back(std::move(field));
}

// The file's rgb where a vertex still has the colour that was loaded, else MeshLab's 8 bits on the file's scale.
std::function<double(std::size_t, std::uint32_t)> LayerReader::colour_values(const Attribute& attribute) const
{
    const ColourScale scale = source_->colour_scale;
    const bool whole = is_whole(attribute.type);
    return [&vertices = layer_.cm.vert, this, scale, whole](std::size_t v, std::uint32_t c) {
        const auto& colour = vertices[v].cC();
        if (kept_ && colour[0] == kept_[v].colour[0] && colour[1] == kept_[v].colour[1] &&
            colour[2] == kept_[v].colour[2])
            return static_cast<double>(kept_[v].rgb[c]);
        const double raw = scale.low + colour[static_cast<int>(c)] / 255.0 * (scale.high - scale.low);
        return whole ? std::round(raw) : raw;
    };
}

// False if a filter has deleted the attribute.
bool LayerReader::find_custom_values(Field& field, const AttributePlace& place) const
{
    std::vector<std::function<double(std::size_t)>> components;
    for (const AttributePlace::Component& component : place.components) {
        const auto* const shown =
            component.held == Held::value ? find_vertex_attribute<Scalar>(layer_, component.name) : nullptr;
        if (shown) {
            components.push_back(
                [shown, attribute = field.attribute](std::size_t v) { return raw_of(double(shown[v]), attribute); });
        } else if (const auto* d = find_vertex_attribute<double>(layer_, component.name)) {
            components.push_back([d](std::size_t v) { return d[v]; });
        } else if (const auto* i = find_vertex_attribute<std::int64_t>(layer_, component.name)) {
            components.push_back([i](std::size_t v) { return static_cast<double>(i[v]); });
            field.whole.push_back(i);
        } else if (const auto* u = find_vertex_attribute<std::uint64_t>(layer_, component.name)) {
            components.push_back([u](std::size_t v) { return static_cast<double>(u[v]); });
            field.whole.push_back(reinterpret_cast<const std::int64_t*>(u));  // the same bits
        }
    }
    if (components.size() != place.components.size()) return false;
    field.value = [components](std::size_t v, std::uint32_t c) { return components[c](v); };
    return true;
}

// Sets the functions that read the field's values. False if they are not selected, or if the layer has lost them.
bool LayerReader::find_values(Field& field, const AttributePlace& place, const LayerSelection& selection) const
{
    const auto& vertices = layer_.cm.vert;
    const Attribute attribute = field.attribute;
    switch (place.kind) {
        case Kind::colour:
            if (!selection.colour) return false;
            field.value = colour_values(attribute);
            return true;
        case Kind::normal:
            if (!selection.normal) return false;
            field.value = [&vertices, attribute](std::size_t v, std::uint32_t c) {
                return raw_of(double(vertices[v].cN()[static_cast<int>(c)]), attribute);
            };
            return true;
        case Kind::quality:
            if (!selection.quality || !layer_.hasDataMask(MeshModel::MM_VERTQUALITY)) return false;
            field.value = [&vertices, attribute](std::size_t v, std::uint32_t) {
                return raw_of(double(vertices[v].cQ()), attribute);
            };
            return true;
        case Kind::radius:
            if (!selection.radius || !layer_.hasDataMask(MeshModel::MM_VERTRADIUS)) return false;
            field.value = [&vertices, attribute](std::size_t v, std::uint32_t) {
                return raw_of(double(vertices[v].cR()), attribute);
            };
            return true;
        case Kind::custom:
            return find_custom_values(field, place);
    }
    return false;
}

void LayerReader::add_file_fields(const LayerSelection& selection)
{
    for (std::size_t s = 0; s < source_->places.size(); ++s) {
        Field field{source_->info.schema[s], {}, {}};
        if (find_values(field, source_->places[s], selection)) add_field(std::move(field), true);
    }
    // The file had no colours: colours are written only if a tool has changed those of some vertex.
    if (source_->has(Kind::colour) || !selection.colour) return;
    const auto& vertices = layer_.cm.vert;
    const bool painted = std::any_of(vertices_.begin(), vertices_.end(), [&](std::size_t v) {
        const auto& colour = vertices[v].cC();
        return !kept_ || colour[0] != kept_[v].colour[0] || colour[1] != kept_[v].colour[1] ||
               colour[2] != kept_[v].colour[2];
    });
    if (!painted) return;
    Attribute rgb{std::string(attribute_name::rgb), ScalarType::u8, 3, 1, 0, {}};
    add_field({rgb, [&vertices](std::size_t v, std::uint32_t c) { return double(vertices[v].cC()[int(c)]); }, {}},
              false);
}

void LayerReader::add_member_fields(const MeshModel& layer, const LayerSelection& selection)
{
    const auto& vertices = layer.cm.vert;
    const auto named = [](std::string_view name, ScalarType type, std::uint32_t components) {
        return Attribute{std::string(name), type, components, 1, 0, {}};
    };
    if (selection.colour && layer.hasDataMask(MeshModel::MM_VERTCOLOR))
        add_field({named(attribute_name::rgb, ScalarType::u8, 3),
                   [&vertices](std::size_t v, std::uint32_t c) { return double(vertices[v].cC()[int(c)]); },
                   {}},
                  false);
    // Every mesh of MeshLab has normals; those of a cloud without normals are zero.
    const bool has_normals = std::any_of(vertices_.begin(), vertices_.end(),
                                         [&](std::size_t v) { return vertices[v].cN() != Point3m(0, 0, 0); });
    if (selection.normal && has_normals)
        add_field({named(attribute_name::normal, ScalarType::f32, 3),
                   [&vertices](std::size_t v, std::uint32_t c) { return double(vertices[v].cN()[int(c)]); },
                   {}},
                  false);
    if (selection.quality && layer.hasDataMask(MeshModel::MM_VERTQUALITY))
        add_field({named(attribute_name::intensity, ScalarType::f32, 1),
                   [&vertices](std::size_t v, std::uint32_t) { return double(vertices[v].cQ()); },
                   {}},
                  false);
    if (selection.radius && layer.hasDataMask(MeshModel::MM_VERTRADIUS))
        add_field({named(attribute_name::radius, ScalarType::f32, 1),
                   [&vertices](std::size_t v, std::uint32_t) { return double(vertices[v].cR()); },
                   {}},
                  false);
}

// Attributes of MeshLab's scalar that do not come from the file.
void LayerReader::add_free_fields(const MeshModel& layer)
{
    std::vector<std::string> ours;
    if (source_)
        for (const AttributePlace& place : source_->places)
            for (const AttributePlace::Component& component : place.components) ours.push_back(component.name);
    for (const vcg::PointerToAttribute& entry : layer.cm.vert_attr) {
        if (entry._name.empty() || std::find(ours.begin(), ours.end(), entry._name) != ours.end()) continue;
        const auto* values = find_vertex_attribute<Scalar>(layer, entry._name);
        if (!values || info_.schema.size() >= max_attributes) continue;
        add_field({Attribute{entry._name, in_double ? ScalarType::f64 : ScalarType::f32, 1, 1, 0, {}},
                   [values](std::size_t v, std::uint32_t) { return double(values[v]); },
                   {}},
                  false);
    }
}

bool LayerReader::read(PointBatch& batch, std::size_t max_points)
{
    const std::size_t n = std::min({max_points, vertices_.size() - next_, points_that_fit_a_batch(info_.schema)});
    shape_batch(batch, info_.schema, info_.grid.has_value(), n);
    if (n == 0) return false;
    const std::size_t* const chosen = vertices_.data() + next_;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3d p = position(chosen[i]);
        for (std::size_t a = 0; a < 3; ++a) {
            if (info_.grid)
                batch.grid_xyz[a][i] =
                    static_cast<std::int32_t>(std::round((p[a] - info_.grid->offset[a]) / info_.grid->scale[a]));
            else
                batch.xyz[a][i] = p[a];
        }
    }
    for (std::size_t f = 0; f < fields_.size(); ++f) {
        const Field& field = fields_[f];
        Column& column = batch.attributes[f];
        const std::uint32_t components = field.attribute.components;
        with_type(field.attribute.type, [&](auto zero) {
            using T = decltype(zero);
            T* to = column.as<T>();
            for (std::size_t i = 0; i < n; ++i)
                for (std::uint32_t c = 0; c < components; ++c, ++to) {
                    if (field.whole.empty())
                        *to = static_cast<T>(field.value(chosen[i], c));
                    else
                        *to = static_cast<T>(field.whole[c][chosen[i]]);
                }
        });
    }
    next_ += n;
    return true;
}

double LayerReader::fraction_read() const { return static_cast<double>(next_) / static_cast<double>(vertices_.size()); }

}  // namespace pcm::host
