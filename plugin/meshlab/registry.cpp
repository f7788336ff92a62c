#include "plugin/meshlab/registry.h"

#include "plugin/meshlab/meshlab.h"
#include "plugin/meshlab/scalar.h"
#include "plugin/meshlab/vertex_attributes.h"
#include "plugin/scene/origin.h"

#include <QApplication>
#include <QMainWindow>
#include <QTimer>

#include <malloc.h>

namespace pcm::host {

namespace {

using Attributes = vcg::tri::Allocator<CMeshO>;

bool has_tag(const MeshModel& layer, const char* tag)
{
    auto& mesh = const_cast<CMeshO&>(layer.cm);
    return Attributes::IsValidHandle(mesh, Attributes::FindPerMeshAttribute<std::string>(mesh, tag));
}

void set_tag(MeshModel& layer, const char* tag, const std::string& text)
{
    Attributes::GetPerMeshAttribute<std::string>(layer.cm, tag)() = text;
}

void remove_tag(MeshModel& layer, const char* tag)
{
    if (has_tag(layer, tag)) Attributes::DeletePerMeshAttribute(layer.cm, tag);
}

}  // namespace

Registry& Registry::instance()
{
    static Registry* const registry = new Registry;
    return *registry;
}

Vec3d Registry::origin_for(MeshDocument& document, const Box3d& box)
{
    watch(document);
    if (in_double) return {0, 0, 0};
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
    MeshDocument& document = document_of(layer);
    watch(document);
    forget_lost(document);
    set_tag(layer, tree_tag, tree.cloud->tree()->folder().string());
    copies_.erase({&document, layer.id()});
    layers_[{&document, layer.id()}] = std::move(tree);
    emit attached(&document, layer.id());
}

void Registry::detach(MeshModel& layer)
{
    drop_copy(layer);
    if (layers_.erase({&document_of(layer), layer.id()}) == 0) return;
    remove_tag(layer, tree_tag);
    emit detached(&document_of(layer), layer.id());
    give_memory_back();
}

void Registry::attach_copy(MeshModel& layer, TreeLayer tree)
{
    watch(document_of(layer));
    copies_[{&document_of(layer), layer.id()}] = std::move(tree);
    emit attached(&document_of(layer), layer.id());
}

void Registry::drop_copy(MeshModel& layer)
{
    if (copies_.erase({&document_of(layer), layer.id()}) == 0) return;
    emit detached(&document_of(layer), layer.id());
    emit copy_dropped(&document_of(layer), layer.id());
    give_memory_back();
}

std::optional<TreeLayer> Registry::drawn(const MeshModel& layer) const
{
    if (auto tree = find(layer)) return tree;
    const auto found = copies_.find({&document_of(layer), layer.id()});
    if (found == copies_.end()) return std::nullopt;
    return found->second;
}

// The caches of a closed cloud leave free blocks in the C library's heaps, which keep them: of a process of 1,069 MB
// 277 MB were in use. After the views have let go of the cloud too.
void Registry::give_memory_back()
{
    if (QCoreApplication::instance())
        QTimer::singleShot(0, this, [] { malloc_trim(0); });
    else
        malloc_trim(0);  // in PyMeshLab there is no event loop
}

std::optional<TreeLayer> Registry::find(const MeshModel& layer) const
{
    const auto found = layers_.find({&document_of(layer), layer.id()});
    if (found == layers_.end() || !has_tag(layer, tree_tag)) return std::nullopt;
    return found->second;
}

void Registry::set_source(MeshModel& layer, std::shared_ptr<const LayerSource> source)
{
    MeshDocument& document = document_of(layer);
    watch(document);
    forget_lost(document);
    remove_tag(layer, source_tag);
    if (source) {
        set_tag(layer, source_tag, source->info.format);
        sources_[{&document, layer.id()}] = std::move(source);
    } else {
        sources_.erase({&document, layer.id()});
    }
}

std::shared_ptr<const LayerSource> Registry::source_of(const MeshModel& layer) const
{
    const auto found = sources_.find({&document_of(layer), layer.id()});
    return found == sources_.end() || !has_tag(layer, source_tag) ? nullptr : found->second;
}

void Registry::watch(MeshDocument& document)
{
    if (!watched_.insert(&document).second) return;
    MeshDocument* const key = &document;
    connect(key, &MeshDocument::meshRemoved, this, [this, key](int mesh_id) { layer_removed(key, mesh_id); });
    connect(key, &QObject::destroyed, this, [this, key] { document_destroyed(key); });
}

// Removes what is kept about layers that MeshLab has removed without a signal.
void Registry::forget_lost(MeshDocument& document)
{
    std::set<int> lost;
    const auto look = [&](const auto& kept) {
        for (const auto& [key, value] : kept)
            if (key.first == &document && !document.getMesh(key.second)) lost.insert(key.second);
    };
    look(layers_);
    look(copies_);
    look(sources_);
    for (const int mesh_id : lost) layer_removed(&document, mesh_id);
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
    if (models_of(*document).empty()) origins_.erase(document);
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
