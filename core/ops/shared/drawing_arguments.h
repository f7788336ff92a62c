// A file that primitives are written to: a drawing, a table or a list.
#pragma once

#include "pcm/cad/primitive_files.h"
#include "pcm/ops/operation.h"

#include <string>
#include <vector>

namespace pcm::ops {

// ".dxf (a layer each, meshes and lines), .scr ...": the formats, for helps.
std::string drawing_formats();

struct DrawingArguments {
    bool overwrite = false;
    // `unit`, `chord` and `arcs`: how primitives are drawn. `overwrite` is declared by the operation.
    void declare(Arguments& arguments);
    // `unit`: a symbol that the cloud states, or empty.
    CadOptions options(const std::string& unit) const;

private:
    std::string unit_ = "stated";
    double chord_ = 0;
    bool arcs_ = false;
};

}  // namespace pcm::ops
