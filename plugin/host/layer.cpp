#include "plugin/host/layer.h"

#include "plugin/host/origin.h"
#include "plugin/host/proxy.h"
#include "plugin/host/text.h"
#include "plugin/host/vertex_attributes.h"

namespace pcm::host {

namespace {

void set_vertex(CVertexO& vertex, const std::array<float, 3>& position, const std::array<std::uint8_t, 3>& colour)
{
    vertex.P() = Point3m(position[0], position[1], position[2]);
    vertex.C() = vcg::Color4b(colour[0], colour[1], colour[2], 255);
}

}  // namespace

std::string origin_line(const Vec3d& origin)
{
    if (origin == Vec3d{0, 0, 0}) return "Coordinates in MeshLab are source coordinates.";
    return "Coordinates in MeshLab are source coordinates minus the document's origin " + exact(origin) + ".";
}

std::string rounding_line(const Box3d& box, const Vec3d& origin, const char* what)
{
    return std::string(what) + " is rounded to " + brief(float_rounding(box, origin)) + " source units.";
}

void clear_layer(MeshModel& layer)
{
    Registry::instance().detach(layer);
    Registry::instance().set_source(layer, nullptr);
    clear_vertex_attributes(layer);
    layer.cm.Clear();  // MeshLab's Reload leaves the old vertices
    const bool visible = layer.visible;
    layer.Clear();
    layer.visible = visible;
}

std::vector<std::string> show_tree(MeshModel& layer, const std::shared_ptr<PointCloud>& cloud)
{
    const TreeInfo& info = cloud->info();
    if (info.points == 0) throw Error(ErrorCode::bad_format, cloud->tree()->folder(), "the tree has no points");
    const Vec3d origin = Registry::instance().origin_for(*layer.parent, info.bounds());
    const Proxy proxy = make_proxy(*cloud, origin);

    clear_layer(layer);
    auto vertex = vcg::tri::Allocator<CMeshO>::AddVertices(layer.cm, proxy.points.size());
    for (const ProxyPoint& point : proxy.points) set_vertex(*vertex++, point.position, point.colour);
    layer.updateDataMask(MeshModel::MM_VERTCOLOR);
    vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
    layer.setLabel(QString::fromStdString(cloud->tree()->folder().filename().string()));
    Registry::instance().attach(layer, {cloud, origin});

    return {grouped(info.points) + " points in " + cloud->tree()->folder().string() + ", " + bytes_text(info.bytes) +
                "; MeshLab's own tools work on a sample of " + grouped(proxy.points.size()) + ".",
            origin_line(origin), rounding_line(info.bounds(), origin, "The sample")};
}

}  // namespace pcm::host
