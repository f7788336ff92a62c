// Primitives as drawings for CAD programs, as tables, and as a list that reads back.
#pragma once

#include "pcm/shapes/primitive.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

enum class CadUnit : std::uint8_t { none, metres, millimetres, centimetres, feet, inches };  // source units

const char* name_of(CadUnit unit);  // "mm"; "" for none
std::optional<CadUnit> cad_unit(const std::string& name);

struct CadOptions {
    CadUnit unit = CadUnit::none;  // what one source unit is; written where a format has units, never converted
    double chord = 0;              // maximum distance of a mesh from its curved surface, source units; 0: MeshOptions'
    bool arcs = false;             // meshes of cylinders and cones: only the arc that points cover, open
    bool overwrite = false;
};

struct CadReport {
    std::size_t written = 0;         // primitives
    std::size_t runs = 0;            // pipe runs (piping/pipe_run.h), which drawings and tables have in addition
    std::vector<std::string> notes;  // "3 planes have no outline and are left out"
};

// By the extension, in source coordinates with all digits; one thread, in bounded memory.
//
// - .dxf: a layer per primitive with its name, true colour and nearest indexed colour. Planes as closed polylines in
//   space and 3DFACEs; the others as closed meshes of 3DFACEs with their axes, and with rims and lines on the surface
//   as polylines in space, for programs that show no faces. Circles across z are circles. A layer per pipe run with its
//   centre line as one polyline in space, whose arcs are followed within the chord.
// - .step, .stp: AP214 with a solid per primitive, with its name and colour; planes as trimmed faces. The file has a
// unit:
//   metres where none is given, which a note says.
// - .ifc: IFC4, for programs that plan buildings and plants: a pipe segment per pipe run, a disc swept along its centre
//   line, whose parts are not written once more; planes as plates without thickness; the others as solids whose use is
//   not known. With names, colours, sizes and their standard deviations. About a site at whole units near the first
//   shape; a unit as in STEP.
// - .scr: a script for AutoCAD and what understands its commands, in the world's coordinates: true solids by CYLINDER,
//   SPHERE, CONE, TORUS and, for a part of a torus, REVOLVE; planes as closed 3DPOLYs. One UNDO takes all of it back;
//   no setting of the program is changed, and its object snaps are ignored.
// - .csv: RFC 4180, a row per primitive: parameters, their standard deviations, what of the shape there is. The header
//   names units. Angles are in degrees. Behind them a row of the kind "pipe run" for each: radius, length along the
//   centre line, its ends, "bends" and "parts"; the column "run" says which one a primitive is a part of.
// - .json: all of it; read_primitives() reads it. Angles are in radians.
//
// Cylinders and cones are drawn whole (see CadOptions::arcs), a torus as far as its arc goes. Hidden primitives are
// left out of drawings and tables, and those without known bounds out of drawings; the notes report it. Throws
// Error(invalid_argument) for an extension that is none of these, for a list in which nothing is to be written, numbers
// that are not finite, and a chord that takes more than 1,000,000 faces; Error(exists); Error(unsupported) for DXF
// and STEP where they were not built; what OutputFile throws.
CadReport write_primitives(const std::filesystem::path& file, const std::vector<Primitive>& primitives,
                           const CadOptions& options = {});
// Whether .step can be written, without loading what writes it: for what is only shown.
bool writes_step();
// Throws what write_primitives() would because of the file's name and of what is there: before long work, not after it.
void check_primitive_file(const std::filesystem::path& file, bool overwrite);
inline constexpr const char* cad_extensions[] = {".dxf", ".step", ".stp", ".ifc", ".scr", ".csv", ".json"};

// {"format": "pcm primitives", "version": 1, "primitives": [...]}, angles in radians. A primitive has "name", "kind"
// and what its kind needs of "point", "axis" (any length but 0), "radius", "half_angle" and "tube_radius". All else may
// be left out: "colour" (red, green, blue), "hidden", "cloud", "bounds" ("outline" of a plane; "from" and "to"; "zero",
// "begin" and "end"), "sigma" ("position", "angle", "radius", "second"; null: infinite), "rms", "noise", "threshold",
// "condition", "inliers", "points", "label", "estimator", "verdict", "issue", "message", "iterations", "seconds".
// Throws Error(invalid_argument) for what no list may have: numbers that are not finite, shapes and names that are
// refused.
std::string json_of(const std::vector<Primitive>& primitives);
// Throws Error(bad_format), naming the primitive and the field.
std::vector<Primitive> parse_primitives(const std::string& json);
std::vector<Primitive> read_primitives(const std::filesystem::path& file);  // at most 64 MB

}  // namespace pcm
