// What the surroundings of each point look like: a surface, a volume such as leaves, or a line such as a wire. Splats
// are shaped by it: discs that lie in the surface, small round ones, thin ones along the line. No OpenGL here.
//
// It is found in the points of a node alone, when they are loaded, so it takes no bytes on disk, and a coarse level's
// shapes are those of its spacing. The points of a segment follow one another in Morton order. Of 64 that do (a group)
// and of each 16 of them (a part) the axes of inertia are taken; s0 <= s1 <= s2 are the variances along them.
//   - A part is flat when s0 < s1 / 16, and s1 > s2 / 64 (else its points are on a line, and do not show a surface).
//   - A group is flat when s0 < s1 / 9: noise of up to three quarters of the spacing does not hide the surface.
//   - A point of a flat part lies in its plane, if the group is flat or half of its parts are (a single one among
//     leaves is chance); a point of another part of a flat group in the group's plane. Others of a group of
//     which half the parts are flat or more are at a crease, which counts as four tenths of a volume.
//   - Groups agree with their neighbours, the two before and the two after: where three quarters of these are flat, one
//     that is not is at a crease; where three quarters are volumes, a flat one counts as eight tenths of a volume.
//   - A group is a line when s1 < s2 / 64 and the directions of its parts are within 25 degrees of its own; where these
//     differ it lies at two places far from each other, and its parts alone are looked at.
//   - All else is a volume, the more so the rounder the group is: with s0 / s1 from 1/9 to 2/9 it goes from none to
//     full.
// Groups of fewer than 16 points, and those at one place, are not judged.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/geometry.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <vector>

namespace pcm {

// In 18 bits: the kind in the upper two; below, the normal of surfaces and the direction of lines (octahedral, a byte
// each: within a degree; its sign means nothing), or how much of a volume it is, from 0 to 65535. A stepped surface has
// the bits of an unknown kind and, not 0 below them, its normal (octahedral, six bits each: within two degrees) and in
// four bits its steps.
using PointShape = std::uint32_t;
enum class Surroundings : std::uint8_t { unknown = 0, surface = 1, volume = 2, line = 3 };
inline constexpr unsigned shape_bits = 18;
inline constexpr std::size_t shape_group = 64, shape_part = 16;

inline bool is_stepped(PointShape shape) { return shape >> 16 == 0 && shape != 0; }
inline Surroundings surroundings_of(PointShape shape)
{
    return is_stepped(shape) ? Surroundings::surface : static_cast<Surroundings>(shape >> 16 & 3u);
}
PointShape shape_of(Surroundings kind,
                    const Vec3d& direction);  // direction of surfaces and lines: a unit vector
Vec3d direction_of(PointShape shape);         // the same again
PointShape volume_shape(double share);        // 0 to 1
double volume_of(PointShape shape);           // share of volumes
// A surface that was measured in these steps (view/depth_steps.h), for a splat of this radius, in the same unit. Other
// shapes, and surfaces whose steps such a splat hides, are returned as they are.
PointShape with_steps(PointShape shape, double step, double radius);
double step_of(PointShape shape);  // in radii, within a fifth; 0 where it is not stepped

// The splat of a point of this shape is this many times as large as its size: a little larger on surfaces, whose discs
// would leave gaps where the points' density changes; smaller in volumes, whose points are farther apart in the picture
// than in space.
double size_factor(PointShape shape);
inline constexpr double surface_factor = 1.15, least_volume_factor = 0.15;

// One of each point. `segments`: the numbers of points of the segments that the positions are of, in order
// (bpc/segments.h); nothing beyond a segment counts, so that a part of a chunk has the shapes of the whole.
void find_shapes(const ChunkPositions& positions, const Vec3d& scale, const std::vector<std::uint32_t>& segments,
                 std::vector<PointShape>& shapes);
// The points in each segment of a node.
std::vector<std::uint32_t> points_of_segments(const Node& node);

// A float with the shape in its lowest bits; the others are those of the radius, from which shaders take it to within
// 2^-6 of it. 0 stays 0.
float with_shape(float radius, PointShape shape);
inline constexpr double largest_of_packed = 1 + 1.0 / 64;  // times the radius

}  // namespace pcm
