// Primitives as DXF.
#include "pcm/cad/drawing_list.h"
#include "pcm/cad/dxf_file.h"
#include "pcm/cad/layer_names.h"
#include "pcm/shapes/shape_drawing.h"

namespace pcm {
namespace {

DxfUnit dxf_unit(CadUnit unit)
{
    switch (unit) {
        case CadUnit::none:
            return DxfUnit::none;
        case CadUnit::metres:
            return DxfUnit::metres;
        case CadUnit::millimetres:
            return DxfUnit::millimetres;
        case CadUnit::centimetres:
            return DxfUnit::centimetres;
        case CadUnit::feet:
            return DxfUnit::feet;
        case CadUnit::inches:
            break;
    }
    return DxfUnit::inches;
}

// The parts of one shape on its layer.
class LayerDrawing : public ShapeDrawing {
public:
    LayerDrawing(DxfFile& dxf, const std::string& layer) : dxf_(dxf), layer_(layer) {}

    void line(const Vec3d& from, const Vec3d& to) override { dxf_.line(layer_, from, to); }
    void polyline(const std::vector<Vec3d>& corners, bool closed) override { dxf_.polyline(layer_, corners, closed); }
    void circle(const Vec3d& centre, double radius) override { dxf_.circle(layer_, centre, {0, 0, 1}, radius); }
    void face(const MeshFace& c) override { dxf_.face(layer_, c[0], c[1], c[2], c[3]); }

private:
    DxfFile& dxf_;
    const std::string& layer_;
};

}  // namespace

void write_drawing(const std::filesystem::path& file, DrawingList& list, const CadOptions& options)
{
    std::vector<std::string> names = list.names();
    std::vector<Rgb> colours;
    Box3d extent;
    for (const Primitive* primitive : list.shown) {
        const Shape& shape = primitive->fit.shape;
        traits_of(shape.kind).extend(shape, primitive->bounds, extent);
        colours.push_back(primitive->colour);
    }
    std::vector<std::vector<Vec3d>> centre_lines;
    for (const PipeRun& run : list.runs) {
        centre_lines.push_back(centre_points(run, options.chord));
        for (const Vec3d& p : centre_lines.back()) extent.extend(p);
        names.push_back(run.name);
        colours.push_back(run.parts.front()->colour);
    }
    const std::vector<std::string> layers = layer_names(names);
    std::vector<DxfLayer> table;
    for (std::size_t i = 0; i < layers.size(); ++i)
        table.push_back({layers[i], nearest_colour_index(colours[i]), colours[i]});
    DxfFile dxf(file, table, {dxf_unit(options.unit), extent});
    for (std::size_t i = 0; i < list.shown.size(); ++i) {
        const Primitive& primitive = *list.shown[i];
        const Shape& shape = primitive.fit.shape;
        LayerDrawing drawing(dxf, layers[i]);
        const std::string why_no_faces =
            traits_of(shape.kind).draw(shape, primitive.bounds, {options.chord, options.arcs}, drawing);
        if (!why_no_faces.empty())
            list.notes.push_back("'" + primitive.name + "' has a line and no faces: " + why_no_faces);
    }
    for (std::size_t i = 0; i < list.runs.size(); ++i)
        dxf.polyline(layers[list.shown.size() + i], centre_lines[i], list.runs[i].is_closed);
    dxf.finish();
}

}  // namespace pcm
