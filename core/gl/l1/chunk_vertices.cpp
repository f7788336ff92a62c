#include "pcm/gl/l1/chunk_vertices.h"

#include "pcm/view/point_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pcm {
namespace {

template <class T>
double largest(const PageVector<T>& values)
{
    T most = 0;
    for (const T value : values) most = std::max(most, value);  // unlike max_element, this is vectorised
    return static_cast<double>(most);
}

// The product is computed in double: a relative grid position may not be exact in float, and must be rounded only once.
template <class T>
void write_vertices(std::byte* to, const std::array<PageVector<T>, 3>& xyz, const Vec3d& scale,
                    const VertexFormat& format, const VertexAttributes& attributes)
{
    const std::size_t stride = format.stride();
    const std::size_t radius_place = format.radius_place();
    const std::uint8_t* const colours = format.colour == ColourSource::none ? nullptr : attributes.colours;
    for (std::size_t i = 0; i < xyz[0].size(); ++i, to += stride) {
        float position[3];
        for (std::size_t a = 0; a < 3; ++a) position[a] = static_cast<float>(static_cast<double>(xyz[a][i]) * scale[a]);
        // Positions are not negative: the sign is free (shaders/splat.vert).
        if (attributes.selected && attributes.selected[i] != 0) position[0] = -position[0];
        std::memcpy(to, position, 12);
        if (colours) std::memcpy(to + VertexFormat::colour_place, colours + 4 * i, 4);
        if (format.radius) {
            float radius = attributes.radii[i];
            if (format.shape) radius = with_shape(radius, attributes.shapes ? attributes.shapes[i] : 0);
            std::memcpy(to + radius_place, &radius, 4);
        }
        if (format.normal) std::memcpy(to + VertexFormat::normal_place, attributes.normals + 3 * i, 12);
    }
}

float typical_of(const float* radii, std::size_t points)
{
    double squares = 0;
    for (std::size_t i = 0; i < points; ++i) squares += static_cast<double>(radii[i]) * static_cast<double>(radii[i]);
    return static_cast<float>(std::sqrt(squares / std::max<double>(1, static_cast<double>(points))));
}

}  // namespace

ChunkVertices make_vertices(const ChunkPositions& positions, const Vec3d& scale, const VertexFormat& format,
                            const VertexAttributes& attributes, std::uint32_t hidden)
{
    ChunkVertices made;
    made.format = format;
    made.points = static_cast<std::uint32_t>(positions.size());
    made.hidden = hidden;
    made.selection = attributes.selected ? attributes.selection : 0;
    made.origin = positions.origin;
    for (std::size_t a = 0; a < 3; ++a)
        made.extent[a] =
            scale[a] * (positions.wide ? largest(positions.wide_xyz[a]) : largest(positions.narrow_xyz[a]));
    made.groups = make_groups(positions, scale, format.radius ? attributes.radii : nullptr);
    for (const VertexGroup& group : made.groups)
        made.largest_radius = std::max(made.largest_radius, group.largest_radius);
    if (format.radius) made.typical_radius = typical_of(attributes.radii, positions.size());
    made.bytes.resize(positions.size() * format.stride());  // gaps between a format's members are 0
    positions.wide ? write_vertices(made.bytes.data(), positions.wide_xyz, scale, format, attributes)
                   : write_vertices(made.bytes.data(), positions.narrow_xyz, scale, format, attributes);
    return made;
}

}  // namespace pcm
