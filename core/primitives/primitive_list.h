// Primitives with names: added, renamed, hidden, deleted, undone, and kept as text. As measure/measure_list.h.
#pragma once

#include "pcm/fit/primitive.h"

#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <vector>

namespace pcm {

// One thread. Every change is one step of undo(); the last 1000 steps are kept. All functions throw
// Error(invalid_argument) for an index that the list does not have, and then change nothing.
class PrimitiveList {
public:
    std::size_t size() const { return primitives_.size(); }
    bool empty() const { return primitives_.empty(); }
    const Primitive& operator[](std::size_t index) const { return *primitives_[index]; }  // index < size()

    // At the end; returns its index. Without a name it gets that of its kind and the first free number: "Cylinder 3".
    std::size_t add(Primitive primitive);
    void add_all(const std::vector<Primitive>& primitives);  // one step
    void rename(std::size_t index, const std::string& name);
    void hide(std::size_t index, bool hidden);
    void replace(std::size_t index, Primitive primitive);
    void remove(std::size_t index);
    void clear();

    bool can_undo() const { return !undone_.empty(); }
    bool can_redo() const { return !redone_.empty(); }
    void undo();
    void redo();

    std::vector<Primitive> all() const;

private:
    using Primitives = std::vector<std::shared_ptr<const Primitive>>;
    void change(Primitives primitives);
    void check_index(std::size_t index) const;

    Primitives primitives_;
    std::deque<Primitives> undone_;
    std::vector<Primitives> redone_;
};

}  // namespace pcm
