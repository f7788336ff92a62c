// The attributes of a point that are uploaded for drawing. No OpenGL here.
#pragma once

#include "pcm/gl/style/splat_style.h"
#include "pcm/view/point_colours.h"

#include <cstdint>

namespace pcm {

// Interleaved, in this order: float[3] position relative to the chunk's origin, source units, never negative (the sign
// of x marks selected points); RGBA8 colour, or a float
// where is_value() of its source (make_values()); float radius, source units; float[3] normal, of length 1 or, where
// the cloud has none, 0. The format names which of the last three are present; with a normal, the colour's bytes are
// present too, used or not. Strides are 12, 16, 20 or 32 bytes, which all divide L1's page, so that a chunk in
// consecutive pages is one array. Normals are full floats: at a graze of 0.1 degree an error of 1e-4 would change a
// disc's visible width by a twentieth.
struct VertexFormat {
    ColourSource colour = ColourSource::none;
    bool radius = false;
    bool normal = false;
    bool shape = false;  // in the lowest bits of the radius (view/point_shapes.h); only with a radius
    // Numbers that the owner of the vertices gives, not 0: of the attribute, for ColourSource::attribute; of the
    // conditions that all points of the chunk's vertices meet.
    std::uint32_t attribute = 0;
    std::uint32_t filter = 0;

    std::uint32_t stride() const
    {
        return normal ? 32u : 12u + (colour != ColourSource::none ? 4u : 0u) + (radius ? 4u : 0u);
    }
    // Byte offsets in a vertex; meaningful for attributes that the format has.
    static constexpr std::uint32_t colour_place = 12;
    std::uint32_t radius_place() const { return normal || colour != ColourSource::none ? 16 : 12; }
    static constexpr std::uint32_t normal_place = 20;

    // Whether vertices of this format have all attributes of `wanted`, of the same points.
    bool serves(const VertexFormat& wanted) const
    {
        return (wanted.colour == ColourSource::none || (wanted.colour == colour && wanted.attribute == attribute)) &&
               (radius || !wanted.radius) && (normal || !wanted.normal) && (shape || !wanted.shape) &&
               filter == wanted.filter;
    }
    // Unique for each format but for `attribute` and `filter`, and below L1Table::max_forms.
    unsigned number() const
    {
        return (radius ? 1u : 0u) + (normal ? 2u : 0u) + (shape ? 4u : 0u) + 8u * static_cast<unsigned>(colour);
    }
};
inline bool operator==(const VertexFormat& a, const VertexFormat& b)
{
    return a.number() == b.number() && a.attribute == b.attribute && a.filter == b.filter;
}
inline bool operator!=(const VertexFormat& a, const VertexFormat& b) { return !(a == b); }

// Exactly the attributes that a style reads; without the owner's numbers. `usable`: see usable_style().
inline VertexFormat format_of(const CloudStyle& usable)
{
    const SplatTraits& splats = traits_of(usable.splats);
    return {traits_of(usable.colour).source, splats.reads_radius, splats.reads_normal, splats.reads_shape};
}

}  // namespace pcm
