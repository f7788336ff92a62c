// Primitives as drawings for CAD programs, as tables, and as a list that reads back.
#pragma once

#include "pcm/fit/primitive.h"

#include <filesystem>
#include <string>
#include <vector>

namespace pcm {

enum class CadUnit : std::uint8_t { none, metres, millimetres, centimetres, feet, inches };  // of source units

struct CadOptions {
    CadUnit unit = CadUnit::none;  // what one source unit is; written where a format has units, never converted
    double chord = 0;              // largest distance of a mesh from its curved surface, source units; 0: radius / 100
    bool overwrite = false;
};

// By the extension: .dxf (planes as polylines and 3DFACEs, cylinders, cones, spheres and tori as meshes, with circles
// and axes; a layer and a colour per primitive), .scr (a script for AutoCAD with true solids), .csv (a row per
// primitive: parameters and their standard deviations), .json (all of it; read_primitives() reads it). Hidden
// primitives are left out of drawings and tables. Throws Error(invalid_argument) for an extension that is none of these
// and for an empty list, Error(exists), Error(unsupported) for DXF where it was not built, what OutputFile throws.
struct CadReport {
    std::size_t written = 0;
    std::vector<std::string> notes;  // "3 planes have no outline and are left out"
};
CadReport write_primitives(const std::filesystem::path& file, const std::vector<Primitive>& primitives,
                           const CadOptions& options = {});

std::string json_of(const std::vector<Primitive>& primitives);
// Throws Error(bad_format), naming the primitive and the field.
std::vector<Primitive> parse_primitives(const std::string& json);
std::vector<Primitive> read_primitives(const std::filesystem::path& file);  // at most 256 MB

}  // namespace pcm
