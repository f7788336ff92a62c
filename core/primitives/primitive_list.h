// Primitives with names: added, renamed, hidden, deleted, undone, and kept as text. As measure/measure_list.h.
#pragma once

#include "pcm/fit/primitive.h"
#include "pcm/system/undo_list.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

// One thread. Every change is one step of undo(); the last 1000 steps are kept. All functions throw
// Error(invalid_argument) for an index that the list does not have, and then change nothing.
class PrimitiveList {
public:
    std::size_t size() const { return list_.size(); }
    bool empty() const { return size() == 0; }
    const Primitive& operator[](std::size_t index) const { return list_[index]; }  // index < size()
    const Primitive& at(std::size_t index) const { return list_.at(index); }

    // At the end; returns its index. Without a name it gets that of its kind and the first free number: "Cylinder 3".
    // Throws what rename() throws.
    std::size_t add(Primitive primitive);
    void add_all(std::vector<Primitive> primitives);  // one step; none for no primitives
    // Names are no key: two primitives may have the same. Throws Error(invalid_argument) for a name that is empty,
    // longer than 1000 bytes, or has control characters.
    void rename(std::size_t index, const std::string& name);
    void hide(std::size_t index, bool hidden);
    void replace(std::size_t index, Primitive primitive);
    void remove(std::size_t index) { list_.remove(index); }
    void clear() { list_.clear(); }

    bool can_undo() const { return list_.can_undo(); }
    bool can_redo() const { return list_.can_redo(); }
    void undo() { list_.undo(); }  // does nothing when there is nothing to undo
    void redo() { list_.redo(); }

    std::vector<Primitive> all() const;

private:
    UndoList<Primitive> list_{"primitive"};
};

// For one that is added: of eight colours that differ, the first that the list has least often.
std::array<std::uint8_t, 3> next_colour(const PrimitiveList& list);

}  // namespace pcm
