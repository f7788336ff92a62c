// Primitives with names: added, renamed, hidden, deleted, undone, and kept as text. As measure/measure_list.h.
#pragma once

#include "pcm/lists/undo_list.h"
#include "pcm/shapes/primitive.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

class PrimitiveList : public UndoList<Primitive> {
public:
    PrimitiveList() : UndoList("primitive") {}

    // At the end; returns its index. Without a name it gets that of its kind and the first free number: "Cylinder 3".
    // Throws what rename() throws.
    std::size_t add(Primitive primitive);
    void add_all(std::vector<Primitive> primitives);  // one step; none for no primitives
    std::vector<Primitive> all() const;
    // The list as it is becomes the one before all steps, as one that was read from a file.
    using UndoList::forget_steps;
};

// For one that is added: of eight colours that differ, the first that the list has least often.
std::array<std::uint8_t, 3> next_colour(const PrimitiveList& list);
// For many that are made together: these colours in turn.
std::array<std::uint8_t, 3> colour_in_turn(std::size_t number);

}  // namespace pcm
