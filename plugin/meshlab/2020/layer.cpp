#include "plugin/meshlab/2020/layer.h"

#include "plugin/meshlab/2020/meshlab.h"
#include "plugin/meshlab/2020/vertex_attributes.h"
#include "plugin/scene/layer_label.h"
#include "plugin/scene/open_clouds.h"
#include "plugin/scene/origin.h"
#include "plugin/scene/proxy.h"
#include "plugin/scene/text.h"

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

void fill_with_sample(MeshModel& layer, const Proxy& sample)
{
    layer.cm.face.clear();
    layer.cm.edge.clear();
    layer.cm.vert.clear();
    layer.cm.fn = layer.cm.en = layer.cm.vn = 0;
    layer.cm.sfn = layer.cm.svn = 0;
    auto vertex = vcg::tri::Allocator<CMeshO>::AddVertices(layer.cm, sample.points.size());
    for (const ProxyPoint& point : sample.points) set_vertex(*vertex++, point.position, point.colour);
    layer.updateDataMask(MeshModel::MM_VERTCOLOR);
    vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
}

void vertices_changed(MeshModel& layer)
{
    for (GLArea* view : views_of(*layer.parent)) {
        MLSceneGLSharedDataContext* shared = view->mvc() ? view->mvc()->sharedDataContext() : nullptr;
        if (!shared) continue;
        shared->meshAttributesUpdated(layer.id(), true, MLRenderingData::RendAtts(true));
        shared->manageBuffers(layer.id());
        view->update();
    }
}

std::vector<std::string> reload_layers(MeshDocument& document, const std::filesystem::path& folder)
{
    std::vector<std::string> lines;
    std::error_code ignored;
    for (MeshModel* layer : document.meshList) {
        const auto shown = Registry::instance().find(*layer);
        if (!shown || !std::filesystem::equivalent(shown->cloud->tree()->folder(), folder, ignored)) continue;
        const auto cloud = open_cloud(folder);
        if (cloud->info().points == 0) {
            clear_layer(*layer);
            lines.push_back("The layer " + layer->label().toStdString() +
                            " is now empty: its tree has no points any more.");
            continue;
        }
        const Matrix44m placement = layer->cm.Tr;
        show_tree(*layer, cloud);
        layer->cm.Tr = placement;
        lines.push_back("The layer " + layer->label().toStdString() + " shows the changed tree.");
    }
    return lines;
}

std::vector<std::string> show_tree(MeshModel& layer, const std::shared_ptr<PointCloud>& cloud)
{
    const TreeInfo& info = cloud->info();
    if (info.points == 0) throw Error(ErrorCode::bad_format, cloud->tree()->folder(), "the tree has no points");
    const Vec3d origin = Registry::instance().origin_for(*layer.parent, info.bounds());
    const auto sample = std::make_shared<const Proxy>(make_proxy(*cloud, origin));
    const Proxy& proxy = *sample;

    clear_layer(layer);
    fill_with_sample(layer, proxy);
    layer.setLabel(tree_label(layer.label(), layer.fullName().toStdString(), cloud->tree()->folder(),
                              proxy.points.size(), info.points));
    TreeLayer tree;
    tree.cloud = cloud;
    tree.origin = origin;
    tree.sample = sample;
    tree.state = state_of(layer, Watched::sample);
    Registry::instance().attach(layer, std::move(tree));

    return {grouped(info.points) + " points in " + cloud->tree()->folder().string() + ", " + bytes_text(info.bytes) +
                (proxy.is_whole ? std::string("; MeshLab's own tools work on a copy of them.")
                                : "; MeshLab's own tools work on a sample of " + grouped(proxy.points.size()) + "."),
            origin_line(origin), rounding_line(info.bounds(), origin, "The sample")};
}

}  // namespace pcm::host
