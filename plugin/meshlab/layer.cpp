#include "plugin/meshlab/layer.h"

#include "pcm/system/tree_folder.h"
#include "plugin/meshlab/meshlab.h"
#include "plugin/meshlab/scalar.h"
#include "plugin/meshlab/vertex_attributes.h"
#include "plugin/scene/layer_label.h"
#include "plugin/scene/open_clouds.h"
#include "plugin/scene/origin.h"
#include "plugin/scene/proxy.h"
#include "plugin/scene/text.h"

namespace pcm::host {

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
    const bool visible = is_shown(layer);
    reset_state(layer);
    set_shown(layer, visible);
}

Vec3d shift_of(const Proxy& sample) { return in_double ? sample.origin : Vec3d{0, 0, 0}; }

ScalarPosition shifted(const std::array<float, 3>& position, const Vec3d& shift)
{
    return {Scalar(double(position[0]) + shift[0]), Scalar(double(position[1]) + shift[1]),
            Scalar(double(position[2]) + shift[2])};
}

void fill_with_sample(MeshModel& layer, const Proxy& sample)
{
    layer.cm.face.clear();
    layer.cm.edge.clear();
    layer.cm.vert.clear();
    layer.cm.fn = layer.cm.en = layer.cm.vn = 0;
    layer.cm.sfn = layer.cm.svn = 0;
    auto vertex = vcg::tri::Allocator<CMeshO>::AddVertices(layer.cm, sample.points.size());
    for (const ProxyPoint& point : sample.points) {
        const ScalarPosition p = shifted(point.position, shift_of(sample));
        vertex->P() = Point3m(p[0], p[1], p[2]);
        vertex->C() = vcg::Color4b(point.colour[0], point.colour[1], point.colour[2], 255);
        ++vertex;
    }
    layer.updateDataMask(MeshModel::MM_VERTCOLOR);
    vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
}

void vertices_changed(MeshModel& layer)
{
    for (GLArea* view : views_of(document_of(layer))) {
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
    for (MeshModel* layer : models_of(document)) {
        const auto shown = Registry::instance().find(*layer);
        if (!shown || !same_tree_folder(shown->cloud->tree()->folder(), folder)) continue;
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
    const Vec3d origin = Registry::instance().origin_for(document_of(layer), info.bounds());
    const auto sample =
        std::make_shared<const Proxy>(make_proxy(*cloud, in_double ? choose_origin(info.bounds()) : origin));
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
            origin_line(origin), rounding_line(info.bounds(), proxy.origin, "The sample")};
}

}  // namespace pcm::host
