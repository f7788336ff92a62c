#include "plugin/meshlab/vertex_attributes.h"

#include <map>
#include <utility>
#include <vector>

namespace pcm::host {

namespace {

using Layer = std::pair<const MeshDocument*, int>;

// Never destroyed, as meshes may be destroyed after any static object.
std::multimap<Layer, vcg::SimpleTempDataBase*>& living()
{
    static auto* const attributes = new std::multimap<Layer, vcg::SimpleTempDataBase*>;
    return *attributes;
}

}  // namespace

void detail::attribute_created(const MeshModel& layer, vcg::SimpleTempDataBase* attribute)
{
    living().insert({{&document_of(layer), layer.id()}, attribute});
}

void detail::attribute_destroyed(vcg::SimpleTempDataBase* attribute)
{
    for (auto it = living().begin(); it != living().end(); ++it)
        if (it->second == attribute) {
            living().erase(it);
            return;
        }
}

void clear_vertex_attributes(MeshModel& layer)
{
    for (const vcg::PointerToAttribute& entry : layer.cm.vert_attr)
        delete static_cast<vcg::SimpleTempDataBase*>(entry._handle);
    layer.cm.vert_attr.clear();
}

namespace {

// Attributes remove themselves from the list when they are destroyed.
template <class Wanted>
void free_matching(const Wanted& wanted)
{
    std::vector<vcg::SimpleTempDataBase*> matching;
    for (const auto& [layer, attribute] : living())
        if (wanted(layer)) matching.push_back(attribute);
    for (vcg::SimpleTempDataBase* attribute : matching) delete attribute;
}

}  // namespace

void free_vertex_attributes(const MeshDocument& document, int mesh_id)
{
    free_matching([&](const Layer& layer) { return layer == Layer(&document, mesh_id); });
}

void free_vertex_attributes(const MeshDocument& document)
{
    free_matching([&](const Layer& layer) { return layer.first == &document; });
}

}  // namespace pcm::host
