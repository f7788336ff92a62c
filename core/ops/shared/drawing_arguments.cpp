#include "pcm/ops/shared/drawing_arguments.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/cad/primitive_files.h"

namespace pcm::ops {

std::string drawing_formats()
{
    return std::string(writes_dxf() ? ".dxf (a layer each, meshes and lines), " : "") +
           (writes_step() ? ".step (solids with names and colours), " : "") +
           ".ifc (pipes, plates and solids), .scr (a script for AutoCAD, with true solids), .csv (parameters and their "
           "uncertainties), .json (a list)";
}

void DrawingArguments::declare(Arguments& arguments)
{
    arguments.add("unit", unit_)
        .as(ValueKind::choice)
        .one_of({{"stated", "As the cloud states"},
                 {"none", "None"},
                 {"m", "Metres"},
                 {"mm", "Millimetres"},
                 {"cm", "Centimetres"},
                 {"ft", "Feet"},
                 {"in", "Inches"}})
        .label("Unit")
        .help("What one unit of the coordinates is; written where a format has units, and never converted")
        .advanced();
    arguments.add("chord", chord_)
        .positive()
        .unit("source units")
        .label("Chord")
        .help("Drawings: largest distance of a mesh from its curved surface")
        .automatic("a hundredth of the radius, of spheres and tori a fiftieth")
        .advanced();
    arguments.add("arcs", arcs_)
        .label("Arcs")
        .help("Draw cylinders and cones only as far around as their points go, open, instead of whole")
        .advanced();
}

CadOptions DrawingArguments::options(const std::string& unit) const
{
    CadOptions options;
    std::string symbol = unit_ == "stated" ? unit : unit_ == "none" ? "" : unit_;
    if (symbol == "ftUS") symbol = "ft";
    options.unit = cad_unit(symbol).value_or(CadUnit::none);
    options.chord = chord_;
    options.arcs = arcs_;
    options.overwrite = overwrite;
    return options;
}

}  // namespace pcm::ops
