// Measures with names: added, renamed, hidden, deleted, undone, and kept as text.
//
// Files of a list are written by measure/measure_export.h.
#pragma once

#include "pcm/lists/undo_list.h"
#include "pcm/measure/measure.h"

#include <cstddef>
#include <filesystem>
#include <string>

namespace pcm {

class MeasureList : public UndoList<Measure> {
public:
    MeasureList() : UndoList("measure") {}

    // At the end; returns its index. A measure without a name gets that of its kind and the first free number:
    // "Distance 1". Throws what rename() throws.
    std::size_t add(Measure measure);

    // All of it as JSON, numbers with all digits; parse() gives the same list back, without steps to undo. Throws
    // Error(invalid_argument) for numbers that are not finite, which JSON lacks.
    std::string text() const;
    // Throws Error(bad_format), naming the measure and the field, for text that is not such a list.
    static MeasureList parse(const std::string& text);
    // Of a file; at most 64 MB. Throws what parse() throws, with the path, and Error(not_found | permission | io).
    static MeasureList read(const std::filesystem::path& file);

private:
    std::string free_name(MeasureKind kind) const;
};

}  // namespace pcm
