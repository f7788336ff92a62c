// What of a list of primitives is drawn.
#pragma once

#include "pcm/cad/primitive_files.h"
#include "pcm/piping/pipe_run.h"

#include <string>
#include <vector>

namespace pcm {

struct DrawingList {
    std::vector<const Primitive*> shown;
    std::vector<PipeRun> runs;       // pipe runs that these make
    std::vector<std::string> notes;  // what is left out, and why

    std::vector<std::string> names() const;  // names of the primitives
    // `file`: "a STEP file", which always has a unit: what is assumed is noted where none is known.
    void note_unit(CadUnit unit, const std::string& file);
};

// Without hidden ones and, `bounded`, those whose bounds are not known. Throws Error(invalid_argument) where nothing is
// left and for numbers that are not finite.
DrawingList drawing_list(const std::vector<Primitive>& primitives, bool bounded);

// Writers of the formats; `file` may be written.
void write_drawing(const std::filesystem::path& file, DrawingList& list, const CadOptions& options);
void write_step(const std::filesystem::path& file, DrawingList& list, const CadOptions& options);
void write_ifc(const std::filesystem::path& file, DrawingList& list, const CadOptions& options);
void write_script(const std::filesystem::path& file, const DrawingList& list, const CadOptions& options);
void write_table(const std::filesystem::path& file, const DrawingList& list, const CadOptions& options);

// Throws Error(unsupported) where STEP files cannot be written.
void require_step(const std::filesystem::path& file);

}  // namespace pcm
