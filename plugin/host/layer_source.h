// What an ordinary layer of MeshLab, loaded from a file by us, remembers of that file.
//
// MeshLab's vertices are float and 8 bits a colour; files hold more. What does not fit is kept beside the vertices, so
// that a vertex that nobody has changed is written with the file's own digits.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/view/point_colours.h"

#include <common/ml_mesh_type.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm::host {

// Where one attribute of the file is in the layer.
struct AttributePlace {
    enum class Kind {
        colour,   // vertex colour; the file's own values in KeptVertex
        normal,   // vertex normal
        quality,  // vertex quality
        radius,   // vertex radius
        custom,   // per-vertex attributes, one a component
    } kind = Kind::custom;
    // How a custom attribute is held. `value` is float and holds raw * scale + offset, which MeshLab's functions can
    // use; the others hold raw numbers that float would round.
    enum class Held { value, f64, i64, u64 };
    struct Component {
        std::string name;  // of the per-vertex attribute
        Held held = Held::value;
    };
    std::vector<Component> components;  // of Kind::custom
};

struct LayerSource {
    FileInfo info;  // schema, grid, position type, metadata of the file
    Vec3d origin{};
    std::vector<AttributePlace> places;  // as many as the schema has attributes
    ColourScale colour_scale;            // from the file's rgb to the vertex colours

    bool has(AttributePlace::Kind kind) const
    {
        return std::any_of(places.begin(), places.end(), [&](const AttributePlace& p) { return p.kind == kind; });
    }
};

// Beside every vertex of a layer that was loaded from a file: what float and 8 bits would round.
struct KeptVertex {
    Vec3d position{};                      // source coordinates
    std::array<float, 3> rgb{};            // the file's own; 16 bits fit
    std::array<std::uint8_t, 3> colour{};  // as shown; while the vertex has it, its colour is the file's
};

// The vertex that shows a position, and the raw number that a float attribute or member shows; the latter is exact for
// what choose_held() holds as a value.
inline Point3m local_position(const Vec3d& position, const Vec3d& origin)
{
    return {static_cast<Scalarm>(position[0] - origin[0]), static_cast<Scalarm>(position[1] - origin[1]),
            static_cast<Scalarm>(position[2] - origin[2])};
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
