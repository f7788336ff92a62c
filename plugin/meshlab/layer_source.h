// The file that an ordinary layer was loaded from, as far as saving the layer needs it.
//
// MeshLab's vertices have float positions and 8 bits per colour component; files have more. The exact values are kept
// next to the vertices, so that unchanged vertices are saved with the file's own digits.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/view/point_colours.h"
#include "plugin/meshlab/scalar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm::host {

// Where the layer holds one attribute of the file.
struct AttributePlace {
    enum class Kind {
        colour,   // vertex colour; the file's values are in KeptVertex
        normal,   // vertex normal
        quality,  // vertex quality
        radius,   // vertex radius
        custom,   // per-vertex attributes, one per component
    } kind = Kind::custom;
    // Type of a custom attribute. `value` is MeshLab's scalar and holds raw * scale + offset, which MeshLab's functions
    // can use; the others hold raw numbers that it would round.
    enum class Held { value, f64, i64, u64 };
    struct Component {
        std::string name;  // name of the per-vertex attribute
        Held held = Held::value;
    };
    std::vector<Component> components;  // for Kind::custom
};

struct LayerSource {
    FileInfo info;  // schema, grid, position type, metadata of the file
    Vec3d origin{};
    std::vector<AttributePlace> places;  // one per attribute of the schema
    ColourScale colour_scale;            // maps the file's rgb to vertex colours

    bool has(AttributePlace::Kind kind) const
    {
        return std::any_of(places.begin(), places.end(), [&](const AttributePlace& p) { return p.kind == kind; });
    }
};

// One per vertex of a layer that was loaded from a file: the values that float and 8 bits would round.
struct KeptVertex {
    Vec3d position{};                      // source coordinates
    std::array<float, 3> rgb{};            // the file's values; float holds 16 bits exactly
    std::array<std::uint8_t, 3> colour{};  // as shown; if the vertex still has it, its colour is the file's
};

// A vertex's position from a source position, and the raw number from the one that MeshLab shows. The latter is exact
// for attributes that choose_held() holds as a value.
inline ScalarPosition local_position(const Vec3d& position, const Vec3d& origin)
{
    return {static_cast<Scalar>(position[0] - origin[0]), static_cast<Scalar>(position[1] - origin[1]),
            static_cast<Scalar>(position[2] - origin[2])};
}

inline double raw_of(double shown, const Attribute& attribute)
{
    if (attribute.scale == 1 && attribute.offset == 0) return shown;
    const double raw = (shown - attribute.offset) / attribute.scale;
    return attribute.type == ScalarType::f32 || attribute.type == ScalarType::f64 ? raw : std::round(raw);
}

// Name of the per-vertex attribute (KeptVertex).
inline constexpr const char* kept_vertices = "pcm_kept";

}  // namespace pcm::host
