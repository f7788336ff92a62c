#include "pcm/cli/commands.h"

#include "pcm/cli/opengl_program.h"
#include "pcm/cli/operation_command.h"

#include <stdexcept>
#include <string>

namespace pcm::cli {
namespace {

void start_program_for_opengl(ops::Context& context, const std::vector<std::string>& words)
{
    context.gpu_radii = [words](const ops::GpuRadiiRequest&) -> ops::Result { start_opengl_program(words); };
    context.render = [words](const ops::RenderRequest&) -> ops::Result { start_opengl_program(words); };
}

// Operations that are filters of MeshLab alone are not in the list.
constexpr const char* names[] = {
    "build", "convert",   "run",    "info",    "verify",  "append",  "compact",    "delete",    "repair",   "query",
    "pick",  "select",    "fit",    "set",     "radii",   "normals", "outliers",   "transform", "align",    "merge",
    "voxel", "subsample", "detect", "measure", "profile", "volume",  "primitives", "render",    "generate",
};

}  // namespace

const std::vector<Command>& commands()
{
    static const std::vector<Command> table = [] {
        std::vector<Command> commands;
        for (const char* name : names) {
            const ops::Row* const row = ops::find_operation(name);
            if (!row) throw std::logic_error(std::string("there is no operation ") + name);
            commands.push_back(operation_command(*row, start_program_for_opengl));
        }
        return commands;
    }();
    return table;
}

}  // namespace pcm::cli
