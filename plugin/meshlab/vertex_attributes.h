// Per-vertex attributes of a layer that are freed with it.
//
// MeshLab's own attributes leak: its meshes drop them without deleting them. These are registered until they are
// destroyed, so they are deleted exactly once, by a filter or with the layer. GUI thread only.
#pragma once

#include "plugin/meshlab/meshlab.h"

#include <string>

namespace pcm::host {

namespace detail {
void attribute_created(const MeshModel& layer, vcg::SimpleTempDataBase* attribute);
void attribute_destroyed(vcg::SimpleTempDataBase* attribute);
}  // namespace detail

template <class T>
class OwnedAttribute : public vcg::SimpleTempData<CMeshO::VertContainer, T> {
public:
    explicit OwnedAttribute(MeshModel& layer) : vcg::SimpleTempData<CMeshO::VertContainer, T>(layer.cm.vert)
    {
        detail::attribute_created(layer, this);
    }
    ~OwnedAttribute() override { detail::attribute_destroyed(this); }
};

// Like vcg's Allocator::AddPerVertexAttribute. No attribute of this name may exist (clear_vertex_attributes). One value
// per existing vertex; vcg keeps the values with their vertices when some are deleted.
template <class T>
OwnedAttribute<T>& add_vertex_attribute(MeshModel& layer, const std::string& name)
{
    auto* attribute = new OwnedAttribute<T>(layer);
    vcg::PointerToAttribute entry;
    entry._name = name;
    entry._sizeof = sizeof(T);
    entry._padding = 0;
    entry._handle = attribute;
    entry._type = typeid(T);
    entry.n_attr = ++layer.cm.attrn;
    layer.cm.vert_attr.insert(entry);
    return *attribute;
}

// The values of an attribute of this name and type, or null. Valid until vertices are added or compacted.
template <class T>
const T* find_vertex_attribute(const MeshModel& layer, const std::string& name)
{
    vcg::PointerToAttribute entry;
    entry._name = name;
    const auto found = layer.cm.vert_attr.find(entry);
    if (found == layer.cm.vert_attr.end() || found->_type != typeid(T) || found->_padding != 0) return nullptr;
    return static_cast<const T*>(static_cast<vcg::SimpleTempDataBase*>(found->_handle)->DataBegin());
}

// Deletes all per-vertex attributes of the layer, including those of MeshLab and other plugins.
void clear_vertex_attributes(MeshModel& layer);

// The layer, or the document with all its layers, was destroyed; `document` is used as a key only.
void free_vertex_attributes(const MeshDocument& document, int mesh_id);
void free_vertex_attributes(const MeshDocument& document);

}  // namespace pcm::host
