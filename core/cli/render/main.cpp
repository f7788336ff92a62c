// pcmlab-render: the operations that need OpenGL. `pcmlab` starts it with its own command line.
#include "pcm/cli/operation_command.h"
#include "pcm/cli/render/draw_pictures.h"
#include "pcm/cli/render/radii.h"

namespace {

void use_opengl(pcm::ops::Context& context, const std::vector<std::string>&)
{
    context.render = [&context](const pcm::ops::RenderRequest& request) {
        return pcm::cli::draw_pictures(request, context.progress);
    };
    context.gpu_radii = [&context](const pcm::ops::GpuRadiiRequest& request) {
        return pcm::cli::radii_on_gpu(request, context.progress);
    };
}

}  // namespace

int main(int argc, char** argv)
{
    using pcm::cli::operation_command;
    const pcm::ops::Row render = pcm::ops::render_row(), radii = pcm::ops::radii_row();
    return pcm::cli::run_program("pcmlab", "Out-of-core point clouds: what needs OpenGL",
                                 {operation_command(render, use_opengl), operation_command(radii, use_opengl)}, argc,
                                 argv);
}
