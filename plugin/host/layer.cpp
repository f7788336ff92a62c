#include "host/layer.h"

#include "host/origin.h"
#include "host/proxy.h"
#include "host/text.h"

#include <cmath>
#include <cstring>

namespace pcm::host {

namespace {

void set_vertex(CVertexO& vertex, const std::array<float, 3>& position, const std::array<std::uint8_t, 3>& colour)
{
    vertex.P() = Point3m(position[0], position[1], position[2]);
    vertex.C() = vcg::Color4b(colour[0], colour[1], colour[2], 255);
}

std::string origin_line(const Vec3d& origin)
{
    if (origin == Vec3d{0, 0, 0}) return "Coordinates in MeshLab are source coordinates.";
    return "Coordinates in MeshLab are source coordinates minus the document's origin " + exact(origin) + ".";
}

std::string rounding_line(const Box3d& box, const Vec3d& origin, const char* what)
{
    return std::string(what) + " is rounded to " + brief(float_rounding(box, origin)) + " source units.";
}

void clear(MeshModel& layer)
{
    Registry::instance().detach(layer);
    layer.cm.Clear();  // Reload does not
    const bool visible = layer.visible;
    layer.Clear();
    layer.visible = visible;
}

}  // namespace

std::vector<std::string> show_tree(MeshModel& layer, const std::shared_ptr<PointCloud>& cloud)
{
    const TreeInfo& info = cloud->info();
    if (info.points == 0) throw Error(ErrorCode::bad_format, cloud->tree()->folder(), "the tree holds no points");
    const Vec3d origin = Registry::instance().origin_for(*layer.parent, info.bounds());
    const Proxy proxy = make_proxy(*cloud, origin);

    clear(layer);
    auto vertex = vcg::tri::Allocator<CMeshO>::AddVertices(layer.cm, proxy.points.size());
    for (const ProxyPoint& point : proxy.points) set_vertex(*vertex++, point.position, point.colour);
    layer.updateDataMask(MeshModel::MM_VERTCOLOR);
    vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
    layer.setLabel(QString::fromStdString(cloud->tree()->folder().filename().string()));
    Registry::instance().attach(layer, {cloud, origin, proxy.has_rgb});

    return {grouped(info.points) + " points in " + cloud->tree()->folder().string() + ", " + bytes_text(info.bytes) +
                "; MeshLab's own tools see a sample of " + grouped(proxy.points.size()) + ".",
            origin_line(origin), rounding_line(info.bounds(), origin, "The sample")};
}

std::vector<std::string> load_points(MeshModel& layer, PointReader& reader, const ProgressFunction& progress)
{
    const FileInfo& info = reader.info();
    const auto rgb_slot = info.schema.find(attribute_name::rgb);
    const auto intensity_slot = info.schema.find(attribute_name::intensity);
    std::vector<Vec3d> positions;
    std::vector<std::byte> rgb_raw, intensity_raw;
    Box3d box;
    std::uint64_t skipped = 0;
    const auto append = [](std::vector<std::byte>& raw, const Column& column, std::size_t i) {
        const std::byte* from = column.data() + i * column.point_bytes();
        raw.insert(raw.end(), from, from + column.point_bytes());
    };
    PointBatch batch;
    while (reader.read(batch, default_batch_points)) {
        for (std::size_t i = 0; i < batch.size; ++i) {
            Vec3d p;
            for (std::size_t a = 0; a < 3; ++a)
                p[a] = batch.gridded ? info.grid->to_source(batch.grid_xyz[a][i], a) : batch.xyz[a][i];
            if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) {
                ++skipped;
                continue;
            }
            positions.push_back(p);
            box.extend(p);
            if (rgb_slot) append(rgb_raw, batch.attributes[*rgb_slot], i);
            if (intensity_slot) append(intensity_raw, batch.attributes[*intensity_slot], i);
        }
        if (progress && !progress({"Reading points", reader.fraction_read(), -1}))
            throw Error(ErrorCode::cancelled, {}, "cancelled");
    }
    if (positions.empty()) throw Error(ErrorCode::bad_format, {}, "the file holds no points");
    const auto column_of = [&](std::size_t slot, const std::vector<std::byte>& raw) {
        Column column(info.schema[slot]);
        column.resize(positions.size());
        std::memcpy(column.data(), raw.data(), raw.size());
        return column;
    };
    Column rgb, intensity;
    if (rgb_slot) rgb = column_of(*rgb_slot, rgb_raw);
    if (intensity_slot) intensity = column_of(*intensity_slot, intensity_raw);
    const bool has_rgb = rgb_slot && rgb.components() >= 3 && !is_black(rgb);
    std::vector<std::array<std::uint8_t, 3>> colours;
    if (has_rgb)
        colours = colours_of(rgb, true);
    else if (intensity_slot)
        colours = colours_of(intensity, false);

    const Vec3d origin = Registry::instance().origin_for(*layer.parent, box);
    clear(layer);
    auto vertex = vcg::tri::Allocator<CMeshO>::AddVertices(layer.cm, positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i, ++vertex) {
        std::array<float, 3> local{};
        for (std::size_t a = 0; a < 3; ++a) local[a] = static_cast<float>(positions[i][a] - origin[a]);
        set_vertex(*vertex, local, colours.empty() ? std::array<std::uint8_t, 3>{191, 191, 191} : colours[i]);
        if (intensity_slot) {
            const Attribute& attribute = info.schema[*intensity_slot];
            vertex->Q() = static_cast<Scalarm>(intensity.value(i) * attribute.scale + attribute.offset);
        }
    }
    layer.updateDataMask(MeshModel::MM_VERTCOLOR);
    if (intensity_slot) layer.updateDataMask(MeshModel::MM_VERTQUALITY);
    vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);

    std::vector<std::string> lines{grouped(positions.size()) + " points, " + info.format + ".", origin_line(origin),
                                   rounding_line(box, origin, "The layer")};
    if (skipped) lines.push_back(grouped(skipped) + " points without a finite position were left out.");
    if (intensity_slot) lines.emplace_back("Intensity is the quality of the vertices.");
    lines.insert(lines.end(), info.notes.begin(), info.notes.end());
    return lines;
}

}  // namespace pcm::host
