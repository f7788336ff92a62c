#include "pcm/cli/commands.h"

#include "pcm/cli/operation_command.h"

namespace pcm::cli {

void start_render(char** arguments);

const std::vector<Command>& commands()
{
    static const std::vector<Command> table = {
        operation_command("build"),
        operation_command("convert"),
        operation_command("info"),
        operation_command("verify"),
        operation_command("append"),
        operation_command("compact"),
        operation_command("delete"),
        operation_command("repair"),
        operation_command("query"),
        operation_command("pick"),
        operation_command("select"),
        operation_command("fit"),
        operation_command("set"),
        operation_command("radii"),
        operation_command("normals"),
        operation_command("outliers"),
        operation_command("transform"),
        operation_command("align"),
        operation_command("merge"),
        operation_command("voxel"),
        operation_command("subsample"),
        operation_command("detect"),
        operation_command("measure"),
        operation_command("profile"),
        operation_command("volume"),
        operation_command("primitives"),
        {"render", "Render trees to PNG, from a camera or along a camera path, without a window", nullptr,
         start_render},
        operation_command("generate"),
    };
    return table;
}

}  // namespace pcm::cli
