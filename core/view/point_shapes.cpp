#include "pcm/view/point_shapes.h"

#include "pcm/bpc/segments.h"
#include "pcm/cloud/symmetric_eigen.h"
#include "pcm/cloud/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace pcm {
namespace {

// Ratios of variances below which a part or a group is flat or a line, and above which it is round.
constexpr double flat_part = 1.0 / 16, flat_group = 1.0 / 9, line = 1.0 / 64, round_group = 2.0 / 9;
constexpr double along_line = 0.9;  // cosine of 25 degrees
constexpr double crease = 0.4;      // as much of a volume
constexpr double among_volumes = 0.8;
// Steps of stepped surfaces are coded_step * 2 ^ (code / steps_of_octave) radii (shaders/splat.vert).
constexpr double coded_step = 1.4142, steps_of_octave = 2;
constexpr std::size_t groups_around = 2;
constexpr std::size_t parts_of_group = shape_group / shape_part;

struct Moments {
    double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

    void add(const Moments& o)
    {
        n += o.n, x += o.x, y += o.y, z += o.z;
        xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    }
    SymmetricMatrix covariance() const
    {
        const double mx = x / n, my = y / n, mz = z / n;
        return {xx / n - mx * mx, xy / n - mx * my, xz / n - mx * mz,
                yy / n - my * my, yz / n - my * mz, zz / n - mz * mz};
    }
};

// Moments of `count` consecutive points from `first` on. `place(i, axis)` is relative to the first, in units in
// which squares are numbers.
template <class Place>
Moments moments_of(std::size_t first, std::size_t count, const Place& place)
{
    float s[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    for (std::size_t i = first; i < first + count; ++i) {
        const float x = place(i, 0), y = place(i, 1), z = place(i, 2);
        s[0] += x, s[1] += y, s[2] += z;
        s[3] += x * x, s[4] += x * y, s[5] += x * z, s[6] += y * y, s[7] += y * z, s[8] += z * z;
    }
    Moments m;
    m.n = static_cast<double>(count);
    m.x = static_cast<double>(s[0]), m.y = static_cast<double>(s[1]), m.z = static_cast<double>(s[2]);
    m.xx = static_cast<double>(s[3]), m.xy = static_cast<double>(s[4]), m.xz = static_cast<double>(s[5]);
    m.yy = static_cast<double>(s[6]), m.yz = static_cast<double>(s[7]), m.zz = static_cast<double>(s[8]);
    return m;
}

// Consecutive points: their axes of inertia.
struct Run {
    SymmetricMatrix covariance;
    SmallestEigenvector axes;
    bool is_line = false;  // or at one place

    explicit Run(const Moments& moments)
        : covariance(moments.covariance()),
          axes(smallest_eigenvector(covariance)),
          is_line(!(axes.values[1] >= line * axes.values[2]) || !(axes.values[2] > 0))
    {
    }
    double ratio() const { return is_line ? 0 : axes.values[0] / axes.values[1]; }
    bool is_flat(double most) const { return !is_line && ratio() < most; }
    // The eigenvector of the largest eigenvalue.
    Vec3d direction() const { return eigensystem(covariance).vectors[2]; }
};

// A group of at most 64 points.
struct Judged {
    std::array<PointShape, parts_of_group> parts{};
    bool is_flat = false;  // or half of its parts are
    bool is_volume = false;
    PointShape volume = 0;
};

void judge_parts(const std::vector<Run>& parts, const Run& group, Judged& judged)
{
    const auto flat = std::count_if(parts.begin(), parts.end(), [](const Run& r) { return r.is_flat(flat_part); });
    judged.is_flat = group.is_flat(flat_group) || 2 * flat >= static_cast<std::ptrdiff_t>(parts.size());
    judged.is_volume = !judged.is_flat;
    double ratio = group.ratio();
    if (group.is_line) {  // two places far from each other
        ratio = 0;
        for (const Run& part : parts) ratio += part.ratio() / static_cast<double>(parts.size());
    }
    const PointShape volume = judged.volume = volume_shape((ratio - flat_group) / (round_group - flat_group));
    for (std::size_t p = 0; p < parts.size(); ++p)
        judged.parts[p] = !judged.is_flat               ? volume
                          : parts[p].is_flat(flat_part) ? shape_of(Surroundings::surface, parts[p].axes.vector)
                          : group.is_flat(flat_group)   ? shape_of(Surroundings::surface, group.axes.vector)
                                                        : volume_shape(crease);
}

// `points`: number of points of the group.
template <class Place>
Judged judge(std::size_t points, const Place& place)
{
    Judged judged;
    if (points < shape_part) return judged;
    const std::size_t count = points / shape_part;  // the last takes what is left
    std::vector<Run> parts;
    Moments all;
    for (std::size_t p = 0; p < count; ++p) {
        const std::size_t first = p * shape_part;
        const Moments moments = moments_of(first, p + 1 == count ? points - first : shape_part, place);
        parts.emplace_back(moments);
        all.add(moments);
    }
    const Run group(all);
    if (!(group.axes.values[2] > 0)) return judged;
    if (group.is_line) {
        const Vec3d direction = group.direction();
        if (std::all_of(parts.begin(), parts.end(),
                        [&](const Run& part) { return std::fabs(dot(part.direction(), direction)) > along_line; })) {
            judged.parts.fill(shape_of(Surroundings::line, direction));
            return judged;
        }
    }
    judge_parts(parts, group, judged);
    return judged;
}

// Whether `is` holds for three quarters of the groups around group `g`.
template <class Is>
bool is_between(const std::vector<Judged>& groups, std::size_t g, const Is& is)
{
    std::size_t matching = 0, others = 0;
    for (std::size_t i = g - std::min(g, groups_around); i <= g + groups_around && i < groups.size(); ++i) {
        if (i == g) continue;
        ++others;
        matching += is(groups[i]);
    }
    return others > 0 && 4 * matching >= 3 * others;
}

// Finds the shapes of the points of a segment.
template <class T>
void find(const std::array<PageVector<T>, 3>& xyz, const Vec3d& scale, std::size_t first, std::size_t end,
          std::vector<PointShape>& shapes)
{
    const double unit = std::max({scale[0], scale[1], scale[2]});
    const std::array<float, 3> step{static_cast<float>(scale[0] / unit), static_cast<float>(scale[1] / unit),
                                    static_cast<float>(scale[2] / unit)};
    std::array<std::array<float, shape_group>, 3> local;
    std::vector<Judged> groups;
    for (std::size_t from = first; from < end; from += shape_group) {
        const std::size_t points = std::min(shape_group, end - from);
        // Relative to a point of the group: differences of integers are exact, whatever the coordinates.
        for (std::size_t a = 0; a < 3; ++a) {
            const T origin = xyz[a][from];
            for (std::size_t i = 0; i < points; ++i)
                local[a][i] =
                    static_cast<float>(static_cast<std::make_signed_t<T>>(xyz[a][from + i] - origin)) * step[a];
        }
        groups.push_back(judge(points, [&](std::size_t i, std::size_t a) { return local[a][i]; }));
    }
    for (std::size_t g = 0; g < groups.size(); ++g) {
        if (groups[g].is_volume && is_between(groups, g, [](const Judged& j) { return j.is_flat; }))
            groups[g].parts.fill(volume_shape(std::min(crease, volume_of(groups[g].volume))));
        else if (groups[g].is_flat && is_between(groups, g, [](const Judged& j) { return j.is_volume; }))
            groups[g].parts.fill(volume_shape(among_volumes));
        const std::size_t from = first + g * shape_group, points = std::min(shape_group, end - from);
        const std::size_t last = std::max<std::size_t>(points / shape_part, 1) - 1;
        for (std::size_t i = 0; i < points; ++i) shapes[from + i] = groups[g].parts[std::min(i / shape_part, last)];
    }
}

double sign_of(double v) { return v < 0 ? -1 : 1; }

// The octahedron |x| + |y| + |z| = 1, its lower half folded outwards onto the square -1 .. 1 (Meyer et al. 2010), x and
// y in this many bits each.
PointShape octahedral(const Vec3d& direction, unsigned bits)
{
    const double size = std::fabs(direction[0]) + std::fabs(direction[1]) + std::fabs(direction[2]);
    double x = direction[0] / size, y = direction[1] / size;
    if (direction[2] < 0) {
        const double folded = (1 - std::fabs(y)) * sign_of(x);
        y = (1 - std::fabs(x)) * sign_of(y);
        x = folded;
    }
    const long most = (1L << bits) - 1;
    const auto part = [most](double v) {
        return static_cast<PointShape>(std::clamp(std::lround((v + 1) * 0.5 * static_cast<double>(most)), 0L, most));
    };
    return part(x) << bits | part(y);
}

Vec3d from_octahedral(PointShape code, unsigned bits)
{
    const PointShape most = (1u << bits) - 1;
    const auto part = [most](PointShape v) { return static_cast<double>(v & most) / (0.5 * most) - 1; };
    double x = part(code >> bits), y = part(code);
    const double z = 1 - std::fabs(x) - std::fabs(y);
    if (z < 0) {
        const double folded = (1 - std::fabs(y)) * sign_of(x);
        y = (1 - std::fabs(x)) * sign_of(y);
        x = folded;
    }
    return normalised(Vec3d{x, y, z});
}

}  // namespace

PointShape shape_of(Surroundings kind, const Vec3d& direction)
{
    return static_cast<PointShape>(kind) << 16 | octahedral(direction, 8);
}

Vec3d direction_of(PointShape shape)
{
    return is_stepped(shape) ? from_octahedral(shape >> 4, 6) : from_octahedral(shape & 0xffffu, 8);
}

PointShape with_steps(PointShape shape, double step, double radius)
{
    if (surroundings_of(shape) != Surroundings::surface) return shape;
    const long octaves = std::lround(steps_of_octave * std::log2(std::clamp(step / radius / coded_step, 1.0, 1e3)));
    if (octaves < 1) return shape;
    return octahedral(direction_of(shape), 6) << 4 | static_cast<PointShape>(std::min(octaves, 15L));
}

double step_of(PointShape shape)
{
    return is_stepped(shape) ? coded_step * std::exp2((shape & 15u) / steps_of_octave) : 0;
}

PointShape volume_shape(double share)
{
    return static_cast<PointShape>(Surroundings::volume) << 16 |
           static_cast<PointShape>(std::lround(std::clamp(share, 0.0, 1.0) * 65535));
}

double volume_of(PointShape shape) { return static_cast<double>(shape & 0xffffu) / 65535; }

double size_factor(PointShape shape)
{
    if (surroundings_of(shape) == Surroundings::surface) return surface_factor;
    return surroundings_of(shape) == Surroundings::volume ? 1 - (1 - least_volume_factor) * volume_of(shape) : 1;
}

void find_shapes(const ChunkPositions& positions, const Vec3d& scale, const std::vector<std::uint32_t>& segments,
                 std::vector<PointShape>& shapes)
{
    shapes.assign(positions.size(), 0);
    std::size_t first = 0;
    for (const std::uint32_t points : segments) {
        const std::size_t end = std::min<std::size_t>(first + points, positions.size());
        positions.wide ? find(positions.wide_xyz, scale, first, end, shapes)
                       : find(positions.narrow_xyz, scale, first, end, shapes);
        first = end;
    }
}

std::vector<std::uint32_t> points_of_segments(const Node& node)
{
    ChunkIdentity identity{};
    identity.level_points = node.level_points;
    std::vector<std::uint32_t> points;
    for (const BpcSegment& segment : segments_of(identity, static_cast<std::uint32_t>(node.points)))
        points.push_back(segment.count);
    return points;
}

float with_shape(float radius, PointShape shape)
{
    if (!(radius > 0)) return 0;
    std::uint32_t bits;
    std::memcpy(&bits, &radius, sizeof bits);
    constexpr std::uint32_t mask = (1u << shape_bits) - 1;
    bits = (bits & ~mask) | (shape & mask);
    float packed;
    std::memcpy(&packed, &bits, sizeof packed);
    return packed;
}

}  // namespace pcm
