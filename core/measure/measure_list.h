// Measures with names: added, renamed, hidden, deleted, undone, and kept as text.
//
// Files of a list are written by measure/measure_export.h.
#pragma once

#include "pcm/measure/measure.h"
#include "pcm/system/undo_list.h"

#include <cstddef>
#include <filesystem>
#include <string>

namespace pcm {

// One thread. Every change is one step of undo(); the last 1000 steps are kept. All functions throw
// Error(invalid_argument) for an index that the list does not have, and then change nothing.
class MeasureList {
public:
    std::size_t size() const { return list_.size(); }
    bool empty() const { return size() == 0; }
    const Measure& operator[](std::size_t index) const { return list_[index]; }  // index < size()
    const Measure& at(std::size_t index) const { return list_.at(index); }

    // At the end; returns its index. A measure without a name gets that of its kind and the first free number:
    // "Distance 1". Throws what rename() throws.
    std::size_t add(Measure measure);
    // Names are no key: two measures may have the same. Throws Error(invalid_argument) for a name that is empty, longer
    // than 1000 bytes, or has control characters.
    void rename(std::size_t index, const std::string& name);
    void hide(std::size_t index, bool hidden);
    // Another one in its place: its points were moved, say.
    void replace(std::size_t index, Measure measure);
    void remove(std::size_t index) { list_.remove(index); }
    void clear() { list_.clear(); }

    bool can_undo() const { return list_.can_undo(); }
    bool can_redo() const { return list_.can_redo(); }
    void undo() { list_.undo(); }  // does nothing when there is nothing to undo
    void redo() { list_.redo(); }

    // All of it as JSON, numbers with all digits; parse() gives the same list back, without steps to undo. Throws
    // Error(invalid_argument) for numbers that are not finite, which JSON lacks.
    std::string text() const;
    // Throws Error(bad_format), naming the measure and the field, for text that is not such a list.
    static MeasureList parse(const std::string& text);
    // Of a file; at most 256 MB. Throws what parse() throws, with the path, and Error(not_found | permission | io).
    static MeasureList read(const std::filesystem::path& file);

private:
    UndoList<Measure> list_{"measure"};
};

}  // namespace pcm
