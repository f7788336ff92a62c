#include "pcm/cli/commands.h"

#include "pcm/cli/opengl_program.h"
#include "pcm/cli/operation_command.h"

#include <string>

namespace pcm::cli {
namespace {

void start_program_for_opengl(ops::Context& context, const std::vector<std::string>& words)
{
    context.gpu_radii = [words](const ops::GpuRadiiRequest&) -> ops::Result { start_opengl_program(words); };
    context.render = [words](const ops::RenderRequest&) -> ops::Result { start_opengl_program(words); };
}

}  // namespace

const std::vector<Command>& commands()
{
    static const std::vector<Command> table = [] {
        std::vector<Command> commands;
        for (const ops::Row& row : ops::operations())
            if (!row.window_only) commands.push_back(operation_command(row, start_program_for_opengl));
        return commands;
    }();
    return table;
}

}  // namespace pcm::cli
