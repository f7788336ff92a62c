// Primitives as a script of AutoCAD's commands: shapes/command_script.h.
#include "pcm/cad/drawing_list.h"
#include "pcm/cad/layer_names.h"
#include "pcm/shapes/command_script.h"
#include "pcm/system/output_file.h"

namespace pcm {

void write_script(const std::filesystem::path& file, const DrawingList& list, const CadOptions& options)
{
    const std::vector<std::string> layers = plain_layer_names(list.names());
    OutputFile output(file);
    CommandScript script([&](const std::string& line) { output.append(line); });
    script.comment("Primitives of a point cloud, in its own coordinates. Run it with the command SCRIPT.");
    script.comment(options.unit == CadUnit::none ? "The unit of lengths is not known."
                                                 : std::string("Lengths are in ") + name_of(options.unit) + ".");
    script.comment("Angles are in degrees, as the drawing has them by default (AUNITS 0).");
    script.lines({"_.UNDO", "_BE"});
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Primitive& primitive = *list.shown[i];
        script.comment(primitive.name);
        const auto& c = primitive.colour;
        const std::string colour = std::to_string(c[0]) + "," + std::to_string(c[1]) + "," + std::to_string(c[2]);
        script.lines({"_.-LAYER", "_M", layers[i], "_C", "_T", colour, layers[i], ""});
        const Shape& shape = primitive.fit.shape;
        traits_of(shape.kind).script(shape, primitive.bounds, script);
    }
    script.lines({"_.UCS", "_W", "_.-LAYER", "_S", "0", "", "_.ZOOM", "_E", "_.UNDO", "_E"});
    output.finish();
}

}  // namespace pcm
