#include "plugin/meshlab/2020/registry.h"

#include "plugin/meshlab/2020/meshlab.h"
#include "plugin/meshlab/2020/vertex_attributes.h"
#include "plugin/scene/origin.h"

#include <QMainWindow>
#include <QTimer>

#include <malloc.h>

namespace pcm::host {

Registry& Registry::instance()
{
    static Registry* const registry = new Registry;
    return *registry;
}

Vec3d Registry::origin_for(MeshDocument& document, const Box3d& box)
{
    watch(document);
    const auto found = origins_.find(&document);
    if (found != origins_.end()) return found->second;
    return origins_[&document] = choose_origin(box);
}

std::optional<Vec3d> Registry::origin_of(const MeshDocument& document) const
{
    const auto found = origins_.find(&document);
    if (found == origins_.end()) return std::nullopt;
    return found->second;
}

void Registry::attach(MeshModel& layer, TreeLayer tree)
{
    MeshDocument& document = *layer.parent;
    watch(document);
    auto tag = vcg::tri::Allocator<CMeshO>::GetPerMeshAttribute<std::string>(layer.cm, tree_tag);
    tag() = tree.cloud->tree()->folder().string();
    copies_.erase({&document, layer.id()});
    layers_[{&document, layer.id()}] = std::move(tree);
    emit attached(&document, layer.id());
}

void Registry::detach(MeshModel& layer)
{
    drop_copy(layer);
    if (layers_.erase({layer.parent, layer.id()}) == 0) return;
    vcg::tri::Allocator<CMeshO>::DeletePerMeshAttribute(layer.cm, tree_tag);
    emit detached(layer.parent, layer.id());
    give_memory_back();
}

void Registry::attach_copy(MeshModel& layer, TreeLayer tree)
{
    watch(*layer.parent);
    copies_[{layer.parent, layer.id()}] = std::move(tree);
    emit attached(layer.parent, layer.id());
}

void Registry::drop_copy(MeshModel& layer)
{
    if (copies_.erase({layer.parent, layer.id()}) == 0) return;
    emit detached(layer.parent, layer.id());
    emit copy_dropped(layer.parent, layer.id());
    give_memory_back();
}

std::optional<TreeLayer> Registry::drawn(const MeshModel& layer) const
{
    if (auto tree = find(layer)) return tree;
    const auto found = copies_.find({layer.parent, layer.id()});
    if (found == copies_.end()) return std::nullopt;
    return found->second;
}

// The caches of a closed cloud leave free blocks in the C library's heaps, which keep them: of a process of 1,069 MB
// 277 MB were in use. After the views have let go of the cloud too.
void Registry::give_memory_back()
{
    QTimer::singleShot(0, this, [] { malloc_trim(0); });
}

std::optional<TreeLayer> Registry::find(const MeshModel& layer) const
{
    const auto found = layers_.find({layer.parent, layer.id()});
    if (found == layers_.end()) return std::nullopt;
    return found->second;
}

void Registry::set_source(MeshModel& layer, std::shared_ptr<const LayerSource> source)
{
    watch(*layer.parent);
    if (source)
        sources_[{layer.parent, layer.id()}] = std::move(source);
    else
        sources_.erase({layer.parent, layer.id()});
}

std::shared_ptr<const LayerSource> Registry::source_of(const MeshModel& layer) const
{
    const auto found = sources_.find({layer.parent, layer.id()});
    return found == sources_.end() ? nullptr : found->second;
}

void Registry::watch(MeshDocument& document)
{
    if (!watched_.insert(&document).second) return;
    MeshDocument* const key = &document;
    connect(key, &MeshDocument::meshRemoved, this, [this, key](int mesh_id) { layer_removed(key, mesh_id); });
    connect(key, &QObject::destroyed, this, [this, key] { document_destroyed(key); });
}

void Registry::layer_removed(MeshDocument* document, int mesh_id)
{
    // MeshLab does not: it would call the decorators of the removed layer with a null reference.
    for (GLArea* view : views_of(*document)) view->iPerMeshDecoratorsListMap.remove(mesh_id);
    if (layers_.erase({document, mesh_id}) + copies_.erase({document, mesh_id}) != 0) {
        emit detached(document, mesh_id);
        give_memory_back();
    }
    sources_.erase({document, mesh_id});
    free_vertex_attributes(*document, mesh_id);
    // In an empty document nothing depends on the origin any more, and the next cloud may be far from it.
    if (document->meshList.empty()) origins_.erase(document);
}

void Registry::document_destroyed(MeshDocument* document)
{
    for (auto* trees : {&layers_, &copies_})
        for (auto it = trees->begin(); it != trees->end();)
            it = it->first.first == document ? trees->erase(it) : std::next(it);
    for (auto it = sources_.begin(); it != sources_.end();)
        it = it->first.first == document ? sources_.erase(it) : std::next(it);
    free_vertex_attributes(*document);
    origins_.erase(document);
    watched_.erase(document);
    give_memory_back();
}

std::vector<GLArea*> views_of(const MeshDocument& document)
{
    // MeshLab does not export GLArea's symbols, which qobject_cast needs; inline members work.
    std::vector<GLArea*> views;
    const auto widgets = QApplication::allWidgets();
    for (QWidget* widget : widgets) {
        if (!widget->inherits("GLArea")) continue;
        auto* view = static_cast<GLArea*>(widget);
        if (view->md() == &document) views.push_back(view);
    }
    return views;
}

QMainWindow* window_of(const GLArea& area)
{
    for (QWidget* widget = area.parentWidget(); widget; widget = widget->parentWidget())
        if (widget->inherits("MainWindow")) return qobject_cast<QMainWindow*>(widget);
    return nullptr;
}

}  // namespace pcm::host
