#include "plugin/meshlab/sample_change.h"

#include "pcm/cloud/affine.h"
#include "plugin/meshlab/layer.h"
#include "plugin/meshlab/meshlab.h"
#include "plugin/scene/text.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pcm::host {

namespace {

using ChangeKind = SampleChange::Kind;
using Positions = std::vector<std::array<float, 3>>;

struct Present {
    Positions positions;
    std::vector<std::array<std::uint8_t, 3>> colours;
};

Present present_vertices(const MeshModel& layer, const Vec3d& shift)
{
    Present present;
    for (const auto& vertex : layer.cm.vert) {
        if (vertex.IsD()) continue;
        std::array<float, 3> position;
        for (std::size_t a = 0; a < 3; ++a) position[a] = static_cast<float>(double(vertex.cP()[int(a)]) - shift[a]);
        present.positions.push_back(position);
        present.colours.push_back({vertex.cC()[0], vertex.cC()[1], vertex.cC()[2]});
    }
    return present;
}

Vec3d wide(const std::array<float, 3>& p) { return {double(p[0]), double(p[1]), double(p[2])}; }

// How far float arithmetic may put the image of a position from where the matrix puts it.
double rounding_of(const Affine& map, const Proxy& sample, const Positions& images)
{
    double from = 0, to = 0, stretch = 0;
    for (std::size_t i = 0; i < images.size(); ++i) {
        from = std::max(from, largest_magnitude(wide(sample.points[i].position)));
        to = std::max(to, largest_magnitude(wide(images[i])));
    }
    for (const Vec3d& row : map.linear)
        stretch = std::max(stretch, std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]));
    return 16 * std::ldexp(1.0, -24) * (to + 2 * from * stretch + largest_magnitude(map.target));
}

bool agrees(const Affine& map, const Proxy& sample, const Positions& images)
{
    const double most = rounding_of(map, sample, images);
    for (std::size_t i = 0; i < images.size(); ++i)
        if (!(largest_magnitude(map(wide(sample.points[i].position)) - wide(images[i])) <= most)) return false;
    return true;
}

// The affine map that is nearest to all pairs (least squares); none for a flat sample.
std::optional<Affine> nearest_map(const Proxy& sample, const Positions& images)
{
    const double n = static_cast<double>(images.size());
    Affine map;
    for (std::size_t i = 0; i < images.size(); ++i) {
        map.pivot = map.pivot + (1 / n) * wide(sample.points[i].position);
        map.target = map.target + (1 / n) * wide(images[i]);
    }
    Affine spread, mixed;  // sums of p p' and q p'
    spread.linear = mixed.linear = {};
    for (std::size_t i = 0; i < images.size(); ++i) {
        const Vec3d p = wide(sample.points[i].position) - map.pivot, q = wide(images[i]) - map.target;
        for (std::size_t r = 0; r < 3; ++r) {
            spread.linear[r] = spread.linear[r] + p[r] * p;
            mixed.linear[r] = mixed.linear[r] + q[r] * p;
        }
    }
    const auto& s = spread.linear;
    const double determinant = spread.determinant(), size = (s[0][0] + s[1][1] + s[2][2]) / 3;
    if (!(determinant > 1e-12 * size * size * size)) return std::nullopt;
    const std::array<Vec3d, 3> inverse{1 / determinant * cross(s[1], s[2]), 1 / determinant * cross(s[2], s[0]),
                                       1 / determinant * cross(s[0], s[1])};  // symmetric
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) map.linear[r][c] = dot(mixed.linear[r], inverse[c]);
    return map;
}

std::optional<Affine> find_map(const Proxy& sample, const Positions& images)
{
    if (images.size() < 4) return std::nullopt;
    const auto fitted = nearest_map(sample, images);
    Affine shift;  // exact where the fit is not: a move must not turn the cloud by the rounding of floats
    if (fitted) {
        shift.pivot = fitted->pivot;
        shift.target = fitted->target;
    } else {
        shift.pivot = wide(sample.points[0].position);
        shift.target = wide(images[0]);
    }
    if (agrees(shift, sample, images)) return shift;
    if (fitted && std::fabs(fitted->determinant()) > 1e-12 && agrees(*fitted, sample, images)) return fitted;
    return std::nullopt;
}

// Indices of the sample's points that are missing among vertices which are otherwise the same, in the same order.
std::optional<std::vector<std::uint32_t>> missing_points(const Proxy& sample, const Positions& present)
{
    std::vector<std::uint32_t> missing;
    std::size_t next = 0;
    for (std::size_t i = 0; i < sample.points.size(); ++i) {
        if (next < present.size() && present[next] == sample.points[i].position)
            ++next;
        else
            missing.push_back(static_cast<std::uint32_t>(i));
    }
    if (next != present.size()) return std::nullopt;
    return missing;
}

std::string counted(std::size_t some, std::size_t all, const char* what)
{
    return grouped(some) + " of " + grouped(all) + " vertices were " + what;
}

void find_moves(const Proxy& sample, const Present& present, SampleChange& change)
{
    std::size_t moved = 0, recoloured = 0;
    for (std::size_t i = 0; i < sample.points.size(); ++i) {
        moved += present.positions[i] != sample.points[i].position;
        recoloured += present.colours[i] != sample.points[i].colour;
    }
    if (recoloured) change.text = "the colours of " + counted(recoloured, sample.points.size(), "changed");
    if (moved) change.text = counted(moved, sample.points.size(), "moved") + (recoloured ? "; " + change.text : "");
    change.kind = moved || recoloured ? ChangeKind::other : ChangeKind::none;
    const auto map = moved && !recoloured ? find_map(sample, present.positions) : std::nullopt;
    if (!map) return;
    change.kind = ChangeKind::moved;
    change.linear = map->linear;
    const Vec3d shift = shift_of(sample);
    change.shift = (*map)(-1.0 * shift) + shift;
}

}  // namespace

SampleChange find_change(const MeshModel& layer, const Proxy& sample)
{
    SampleChange change;
    const Present present = present_vertices(layer, shift_of(sample));
    const std::size_t now = present.positions.size(), before = sample.points.size();
    if (now > before) {
        change.kind = ChangeKind::other;
        change.text = grouped(now - before) + " vertices were added";
    } else if (now == before) {
        find_moves(sample, present, change);
    } else {
        change.text = counted(before - now, before, "deleted");
        const auto missing = missing_points(sample, present.positions);
        change.kind = missing ? ChangeKind::deleted : ChangeKind::other;
        if (missing)
            change.deleted = *missing;
        else
            change.text += ", and others were moved";
    }
    if (layer.cm.fn > 0 || layer.cm.en > 0) {
        change.kind = ChangeKind::other;
        change.text += (change.text.empty() ? "" : "; ") + std::string("faces or edges were added");
    }
    return change;
}

std::string sample_warning(const MeshModel& layer)
{
    const auto tree = Registry::instance().find(layer);
    if (!tree || !tree->sample || state_of(layer, Watched::sample) == tree->state) return {};
    const SampleChange change = find_change(layer, *tree->sample);
    if (change.kind == ChangeKind::none) return {};
    return "The layer '" + layer.label().toStdString() + "': " + change.text + ", but only in MeshLab's sample; the " +
           grouped(tree->cloud->info().points) + " points of the cloud are unchanged. " +
           (change.kind == ChangeKind::deleted
                ? "Filters > Point Set > Delete Points of Point Cloud Tree deletes points of the cloud. "
                : "Filters > Point Set has filters for the cloud. ") +
           "File > Reload restores the sample.";
}

void unfreeze(MeshModel& layer, const Proxy& sample, const SampleChange& moved)
{
    const auto& m = moved.linear;
    Matrix44m frozen;
    frozen.SetIdentity();
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) frozen[r][c] = static_cast<Scalarm>(m[std::size_t(r)][std::size_t(c)]);
        frozen[r][3] = static_cast<Scalarm>(moved.shift[std::size_t(r)]);
    }
    std::size_t next = 0;
    for (auto& vertex : layer.cm.vert) {
        if (vertex.IsD()) continue;
        const ScalarPosition p = shifted(sample.points[next++].position, shift_of(sample));
        vertex.P() = Point3m(p[0], p[1], p[2]);
        const Vec3d n{double(vertex.N()[0]), double(vertex.N()[1]), double(vertex.N()[2])};
        const Vec3d back = n[0] * m[0] + n[1] * m[1] + n[2] * m[2];  // normals are moved by the inverse, transposed
        if (length(back) > 0) {
            const Vec3d unit = length(n) / length(back) * back;
            vertex.N() = Point3m(Scalarm(unit[0]), Scalarm(unit[1]), Scalarm(unit[2]));
        }
    }
    layer.cm.Tr = layer.cm.Tr * frozen;
    vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
    vertices_changed(layer);
}

void restore_sample(MeshModel& layer, const Proxy& sample)
{
    fill_with_sample(layer, sample);
    vertices_changed(layer);
}

}  // namespace pcm::host
