// The pcmlab command: build, convert, info, verify, render, generate, append, compact, delete, repair, query, set,
// transform.
#include "pcm/cli/common.h"

#include <string>

int main(int argc, char** argv)
{
    CLI::App app{"Out-of-core point clouds"};
    app.name("pcmlab");
    app.require_subcommand(1);
    int result = 0;
    pcm::cli::add_build(app, result);
    pcm::cli::add_convert(app, result);
    pcm::cli::add_info(app, result);
    pcm::cli::add_verify(app, result);
    pcm::cli::add_append(app, result);
    pcm::cli::add_compact(app, result);
    pcm::cli::add_delete(app, result);
    pcm::cli::add_repair(app, result);
    pcm::cli::add_query(app, result);
    pcm::cli::add_set(app, result);
    pcm::cli::add_transform(app, result);
    pcm::cli::add_render(app);
    pcm::cli::add_generate(app, result);

    return pcm::cli::run(app, argc, argv, result, [&] {
        if (argc > 1 && std::string(argv[1]) == "render") pcm::cli::run_render(argv + 1);
    });
}
